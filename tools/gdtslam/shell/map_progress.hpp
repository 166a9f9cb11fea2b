// How far a log is mapped, on a line of the terminal: scans, then loops that are closed, then the files that are made,
// to the last one, so that the line is never blank while there is something to wait for.
#pragma once

#include <string_view>

#include "console.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

class MapProgress {
 public:
  explicit MapProgress(bool quiet) : scans_("scans", quiet), rest_(quiet) {}

  /// Lets the request draw here. It must not outlive this object.
  void follow(MapRequest& request);
  /// Says that this is being made.
  void making(std::string_view what);
  /// Wipes the line.
  void clear();
  /// Since it was made: all that was waited for.
  [[nodiscard]] double elapsed_s() const { return rest_.elapsed_s(); }

 private:
  ProgressLine scans_;
  TerminalLine rest_;
};

}  // namespace gdtslam

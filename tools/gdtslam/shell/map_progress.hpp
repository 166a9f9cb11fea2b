// Progress line of mapping a log: scans, then loop closures, then each output file, so the line is never blank while
// the user waits.
#pragma once

#include <string_view>

#include "console.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

class MapProgress {
 public:
  explicit MapProgress(bool quiet) : scans_("scans", quiet), rest_(quiet) {}

  /// Draws the request's progress here. The request must not outlive this object.
  void follow(MapRequest& request);
  /// Shows that this file is being made.
  void making(std::string_view what);
  /// Wipes the line.
  void clear();
  /// Seconds since construction, all waiting included.
  [[nodiscard]] double elapsed_s() const { return rest_.elapsed_s(); }

 private:
  ProgressLine scans_;
  TerminalLine rest_;
};

}  // namespace gdtslam

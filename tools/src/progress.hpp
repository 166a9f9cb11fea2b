// One line on standard error that says how far a run is: share done, scans a second, time left. It is drawn only when
// standard error is a terminal, at most ten times a second, so that pipes and logs stay clean.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace gdtslam {

class ProgressLine {
 public:
  /// `unit` is what is counted, for example "scans"; nothing is ever drawn when `quiet`.
  ProgressLine(std::string unit, bool quiet);
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine();

  /// `share` is 0 to 1, negative when unknown.
  void update(std::uint64_t count, double share);
  /// Wipes the line; also done at the end of its life.
  void clear();

  /// "  42 %  5,730 scans  2,880/s  3 s left": what update() draws; apart, to be tested.
  static std::string text(const std::string& unit, std::uint64_t count, double share, double elapsed_s);

 private:
  using Clock = std::chrono::steady_clock;
  std::string unit_;
  bool enabled_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

}  // namespace gdtslam

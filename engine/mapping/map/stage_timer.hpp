// Adds the time until the end of its scope to a stage.
#pragma once

#include <chrono>

namespace gdtslam {

class StageTimer {
 public:
  explicit StageTimer(double& seconds) : seconds_(&seconds), start_(Clock::now()) {}
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer() { *seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double* seconds_;
  Clock::time_point start_;
};

}  // namespace gdtslam

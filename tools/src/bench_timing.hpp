// Measures how long something takes, wall and CPU time, on a machine that does other things as well: many samples, of
// which the median counts and the spread is told.
#pragma once

#include <functional>

namespace gdtslam {

struct TimingOptions {
  int samples = 15;
  double sample_s = 0.004;  ///< a sample repeats the work until it takes this long
};

/// Seconds for one execution of the work.
struct Timing {
  double wall_s = 0.0;     ///< median
  double cpu_s = 0.0;      ///< median over the samples, all threads of the process
  double fastest_s = 0.0;  ///< CPU time of the fastest and of the slowest sample
  double slowest_s = 0.0;
  int samples = 0;
};

/// Throws Error(kInterrupted) where a signal came in between.
Timing measure(const std::function<void()>& work, const TimingOptions& options);

}  // namespace gdtslam

// Measures how long something takes on a machine that does other things as well: many samples, of which the median
// counts and the spread is told. Wall time, CPU time of all threads, and the device's own time where it has a clock.
#pragma once

#include <functional>
#include <optional>

namespace gdtslam {

struct TimingOptions {
  int samples = 15;         ///< at most
  double sample_s = 0.004;  ///< a sample repeats the work until it takes this long
  double longest_s = 2.0;   ///< no further sample after this long, once there are kFewestSamples
  static constexpr int kFewestSamples = 3;
};

/// Something to be timed. Steps are put in line, then waited for together, so that what a wait costs does not count for
/// each of them; the times are those of one step.
struct Work {
  std::function<void()> step;
  std::function<void()> wait{};  ///< empty: a step is done when it returns
  std::function<double()>
      device_ns{};  ///< the device's time for what was waited for last, negative where it cannot tell
  int most_in_line = 1 << 20;
};

/// Seconds for one step.
struct Timing {
  double wall_s = 0.0;     ///< median
  double cpu_s = 0.0;      ///< median over the samples, all threads of the process
  double fastest_s = 0.0;  ///< CPU time of the fastest and of the slowest sample
  double slowest_s = 0.0;
  std::optional<double> device_s;  ///< median, by the device's clock
  int samples = 0;
};

/// Throws Error(kInterrupted) where a signal came in between.
Timing measure(const Work& work, const TimingOptions& options);

}  // namespace gdtslam

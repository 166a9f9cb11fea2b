// How sure a motion is. Thread-safe, constant time.
#pragma once

namespace gdtslam {

/// Standard deviations of a motion that the wheels measured, along each axis and in heading.
struct MotionNoise {
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
};

}  // namespace gdtslam

#include "gdtslam/core/angle.hpp"

#include <cmath>

namespace gdtslam {

double wrap_angle(double angle_rad) {
  if (angle_rad > -kPi && angle_rad <= kPi) {
    return angle_rad;
  }
  // IEEE 754 remainder is exact, hence the same everywhere.
  const double wrapped_rad = std::remainder(angle_rad, kTwoPi);
  return wrapped_rad <= -kPi ? kPi : wrapped_rad;
}

}  // namespace gdtslam

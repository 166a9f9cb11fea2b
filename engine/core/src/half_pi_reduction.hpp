// The remainder of an angle after whole quarter turns, as a sum of two doubles. Radians. Thread-safe.
#pragma once

#include <cstdint>

namespace gdtslam::elementary {

/// angle = (n pi/2) + high + low with |high| <= pi/4 (by a hair more), |low| <= ulp(high)/2 and quadrant = n mod 4.
struct ReducedAngle {
  double high;
  double low;
  std::uint64_t quadrant;
};

/// Any finite angle. Relative error of the remainder below 2^-63.
ReducedAngle reduce_by_half_pi(double angle_rad);

}  // namespace gdtslam::elementary

// The remainder of an angle after whole quarter turns, as a difference of two doubles. Radians. Thread-safe.
#pragma once

#include <cstdint>

namespace gdtslam::elementary {

/// angle = n pi/2 + high - excess with |high| <= pi/4 (by a hair more), |excess| below an ulp of high, quadrant = n
/// mod 4. A difference, since -0 - (+0) keeps the sign of an angle of -0 and a sum would not.
struct ReducedAngle {
  double high;
  double excess;
  std::uint64_t quadrant;
};

/// Any finite angle. Relative error of the remainder below 2^-63.
ReducedAngle reduce_by_half_pi(double angle_rad);

}  // namespace gdtslam::elementary

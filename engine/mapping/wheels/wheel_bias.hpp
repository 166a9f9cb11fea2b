// The bias of the wheels: they miss a share of the distance (WheelScale learns it), a share of the turn, and turn with
// every metre, as wheels of unequal size do. The two of the turn are estimated by robust least squares from stretches
// whose true turn is known better. Thread-safe. Cost: linear in the stretches.
#pragma once

#include <span>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

struct WheelBias {
  double distance = 0.0;        ///< share that is missing in distances
  double turn = 0.0;            ///< share that is missing in turns
  double turn_rad_per_m = 0.0;  ///< turn that is missing in each metre forward
  double sigma_distance = 0.05;
  double sigma_turn = 0.05;
  double sigma_rad_per_m = 0.05;
};

/// A stretch of the path by the wheels, and what is known of it otherwise.
struct WheelStretch {
  double path_m = 0.0;
  double turned_rad = 0.0;
  double forward_m = 0.0;  ///< signed, as the next
  double turn_rad = 0.0;
  double true_turn_rad = 0.0;
};

/// Length that the variance of a heading by the wheels grows with: radians, or half the metres.
inline double heading_walk(double path_m, double turned_rad) { return 0.5 * path_m + turned_rad; }

/// The turns', of stretches that overlap so that each piece is in `overlap` of them. Without any: nothing, as uncertain
/// as wheels are that nobody knows.
WheelBias estimate_bias(std::span<const WheelStretch> stretches, double overlap);

/// The share that is added to distances: what stands out of three standard deviations.
double distance_added(const WheelBias& bias);
/// The motion less what stands out of three of its own standard deviations: wheels that are good are left alone.
Pose2 corrected(const Pose2& by_wheels, const WheelBias& bias);

}  // namespace gdtslam

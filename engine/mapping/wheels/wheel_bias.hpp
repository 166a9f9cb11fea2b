// The bias of the wheels: a missing share of the distance (WheelScale learns it), a missing share of the turn, and a
// turn in each metre, as of wheels of unequal size. Robust least squares estimate the two of the turn from stretches
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

/// A stretch of the path by the wheels, and its true turn by other sources.
struct WheelStretch {
  double path_m = 0.0;
  double turned_rad = 0.0;
  double forward_m = 0.0;  ///< signed, as the next
  double turn_rad = 0.0;
  double true_turn_rad = 0.0;
};

/// Length that the variance of a wheel heading grows with: radians, or half the metres.
inline double heading_walk(double path_m, double turned_rad) { return 0.5 * path_m + turned_rad; }

/// Estimates the bias of the turns from stretches that overlap so that each piece is in `overlap` of them. Without
/// stretches: zero, with the uncertainty of unknown wheels.
WheelBias estimate_bias(std::span<const WheelStretch> stretches, double overlap);

/// The share that is added to distances: the part that exceeds three standard deviations.
double distance_added(const WheelBias& bias);
/// The motion corrected by the part of the bias that exceeds three standard deviations: good wheels stay unchanged.
Pose2 corrected(const Pose2& by_wheels, const WheelBias& bias);

}  // namespace gdtslam

// What the wheels get wrong always: a share of the distance, a share of the turn, and a turn with every metre, as of
// wheels of unequal size; estimated by robust least squares from stretches of which the true motion is known better.
// Thread-safe. Cost: linear in the stretches.
#pragma once

#include <cstddef>
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

/// A way of the wheels' distances in true directions. By the wheels' own turns, whose noise bends it, its chord would
/// be too short, and what the turns get wrong would be taken for missing distance.
class StraightenedWay {
 public:
  /// One step on, by the wheels and in truth.
  void add(const Pose2& by_wheels, const Pose2& in_truth) {
    const double turn_rad = heading_rad_ + 0.5 * (in_truth.theta_rad - by_wheels.theta_rad);
    end_ = end_ + (Pose2{0.0, 0.0, turn_rad} * by_wheels).translation();
    heading_rad_ += in_truth.theta_rad;
  }
  /// Between its ends.
  [[nodiscard]] double chord_m() const { return end_.norm(); }

 private:
  Point2 end_{0.0, 0.0};
  double heading_rad_ = 0.0;
};

/// A stretch of the path by the wheels, and what is known of it otherwise.
struct WheelStretch {
  double path_m = 0.0;
  double turned_rad = 0.0;
  double forward_m = 0.0;  ///< signed, as the next
  double turn_rad = 0.0;
  double chord_m = 0.0;       ///< between its ends by the wheels' distances: StraightenedWay
  double true_chord_m = 0.0;  ///< and in truth
  double true_turn_rad = 0.0;
  bool knows_way = true;  ///< the true chord is known, not only the turn
};

/// What the variance of a heading by the wheels grows with: radians, or half the metres.
inline double walk_of(double path_m, double turned_rad) { return 0.5 * path_m + turned_rad; }

/// Of stretches that overlap so that each piece is in `overlap` of them. Without any: nothing, as uncertain as wheels
/// are that nobody knows.
WheelBias estimate_bias(std::span<const WheelStretch> stretches, double overlap);

/// The motion less what stands out of three of its own standard deviations: wheels that are good are left alone.
Pose2 corrected(const Pose2& by_wheels, const WheelBias& bias);

}  // namespace gdtslam

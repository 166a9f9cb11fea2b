#include "pose_interpolation.hpp"

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

Pose2 linear(const Pose2& from, const Pose2& to, double share) {
  return {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m),
          wrap_angle(from.theta_rad + share * wrap_angle(to.theta_rad - from.theta_rad))};
}

/// A share of a motion, along one arc.
Pose2 part_of(const Pose2& motion, double share) { return exp_se2(share * log_se2(motion)); }

// What is left over at the end is a motion of the map. Its share is one about the same centre: where a turn was
// measured wrongly, that is where the robot turned.
Pose2 along_odometry(const PoseFix& from, const PoseFix& to, double share, const Pose2& T_odom_base) {
  const auto by_odometry = [&from](const Pose2& T_odom) { return from.T_map_base * between(from.T_odom_base, T_odom); };
  const Pose2 residual = to.T_map_base * inverse(by_odometry(to.T_odom_base));
  return part_of(residual, share) * by_odometry(T_odom_base);
}

}  // namespace

Pose2 interpolate(PoseInterpolation how, const PoseFix& from, const PoseFix& to, double share,
                  const Pose2& T_odom_base) {
  switch (how) {
    case PoseInterpolation::kLinear:
      return linear(from.T_map_base, to.T_map_base, share);
    case PoseInterpolation::kOdometry:
      return along_odometry(from, to, share, T_odom_base);
    case PoseInterpolation::kGeodesic:
      break;
  }
  return from.T_map_base * part_of(between(from.T_map_base, to.T_map_base), share);
}

}  // namespace gdtslam

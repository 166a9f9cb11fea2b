#include "pose_path.hpp"

#include <algorithm>
#include <cmath>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kFurthestPose = 4.0;  // limit for continuing a motion, as a multiple of the time between two nodes

// Variance of the odometry, relative to that of a radian of turn.
constexpr double kVariancePerMetre = 0.2;
constexpr double kVariancePerSecond = 1.0e-5;

double path_variance(const PoseFix& from, const PoseFix& to) {
  const Pose2 motion = between(from.T_odom_base, to.T_odom_base);
  return std::fabs(motion.theta_rad) + kVariancePerMetre * translation_length(motion) +
         kVariancePerSecond * std::fabs(to.stamp_s - from.stamp_s);
}

std::vector<double> shares_of_variance(const PoseFix& from, const PoseFix& to, std::span<const PoseFix> nodes) {
  std::vector<double> shares;
  double sum = 0.0;
  const PoseFix* last = &from;
  for (const PoseFix& node : nodes) {
    sum += path_variance(*last, node);
    shares.push_back(sum);
    last = &node;
  }
  sum += path_variance(*last, to);
  for (double& share : shares) share = sum > 0.0 ? share / sum : 1.0;
  return shares;
}

std::vector<double> shares_of_time(const PoseFix& from, const PoseFix& to, std::span<const PoseFix> nodes) {
  const double span_s = to.stamp_s - from.stamp_s;
  std::vector<double> shares;
  for (const PoseFix& node : nodes) {
    shares.push_back(span_s > 0.0 ? std::clamp((node.stamp_s - from.stamp_s) / span_s, 0.0, 1.0) : 1.0);
  }
  return shares;
}

Pose2 linear(const Pose2& from, const Pose2& to, double share) {
  return {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m),
          wrap_angle(from.theta_rad + share * wrap_angle(to.theta_rad - from.theta_rad))};
}

/// A share of a motion, along one arc.
Pose2 motion_share(const Pose2& motion, double share) {
  const Tangent2 whole = log_tangent(motion);
  return exp_tangent({share * whole[0], share * whole[1], share * whole[2]});
}

// The remaining motion at the end belongs to the map frame. Its share is a motion about the same centre: if a turn was
// measured wrongly, the robot turned there.
Pose2 along_odometry(const PoseFix& from, const PoseFix& to, double share, const Pose2& T_odom_base) {
  const auto by_odometry = [&from](const Pose2& T_odom) { return from.T_map_base * between(from.T_odom_base, T_odom); };
  const Pose2 residual = to.T_map_base * inverse(by_odometry(to.T_odom_base));
  return motion_share(residual, share) * by_odometry(T_odom_base);
}

}  // namespace

PoseFix by_odometry(const PoseFix& fix, double stamp_s, const Pose2& T_odom_base) {
  return {stamp_s, fix.T_map_base * between(fix.T_odom_base, T_odom_base), T_odom_base};
}

void place_between(PoseInterpolation how, const PoseFix& from, const PoseFix& to, std::span<PoseFix> nodes) {
  const std::vector<double> shares =
      how == PoseInterpolation::kOdometry ? shares_of_variance(from, to, nodes) : shares_of_time(from, to, nodes);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    nodes[k].T_map_base = interpolate(how, from, to, shares[k], nodes[k].T_odom_base);
  }
}

Pose2 PosePath::at(std::size_t index, double offset_s) const {
  const bool goes_back = index + 1 == nodes_.size() || (offset_s < 0.0 && index > 0);
  if (nodes_.size() == 1) return nodes_.front().T_map_base;
  const PoseFix& from = nodes_[goes_back ? index - 1 : index];
  const PoseFix& to = nodes_[goes_back ? index : index + 1];
  const double span_s = to.stamp_s - from.stamp_s;
  if (!(span_s > 0.0)) return nodes_[index].T_map_base;
  const double share =
      std::clamp((nodes_[index].stamp_s + offset_s - from.stamp_s) / span_s, -kFurthestPose, kFurthestPose);
  return from.T_map_base * motion_share(between(from.T_map_base, to.T_map_base), share);
}

std::vector<PoseKnot> PosePath::knots(std::size_t index, std::span<const PhaseKnot> phases,
                                      const Pose2& T_map_fix) const {
  const double first_s = phases.front().offset_s;
  const double last_s = phases.back().offset_s;
  std::vector<PoseKnot> knots;
  const auto add = [&](double offset_s) {
    knots.push_back({offset_s, between(T_map_fix, offset_s == 0.0 ? nodes_[index].T_map_base : at(index, offset_s))});
  };
  add(first_s);
  if (first_s < 0.0 && last_s > 0.0) add(0.0);
  if (last_s > first_s) add(last_s);
  return knots;
}

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
  return from.T_map_base * motion_share(between(from.T_map_base, to.T_map_base), share);
}

}  // namespace gdtslam

#include "pose_path.hpp"

#include <algorithm>

namespace gdtslam {
namespace {

constexpr double kFurthest = 4.0;  // of the time between two nodes that a motion is continued for

}  // namespace

PoseFix by_odometry(const PoseFix& fix, const ScanRecord& record) {
  const Pose2 T_odom = record.T_odom_base.value_or(fix.T_odom_base);
  return {record.scan.stamp_s, fix.T_map_base * between(fix.T_odom_base, T_odom), T_odom};
}

PoseFix between_fixes(PoseInterpolation how, const PoseFix& from, const PoseFix& to, double stamp_s,
                      const std::optional<Pose2>& T_odom_base) {
  const double span_s = to.stamp_s - from.stamp_s;
  const double share = span_s > 0.0 ? std::clamp((stamp_s - from.stamp_s) / span_s, 0.0, 1.0) : 1.0;
  if (how == PoseInterpolation::kOdometry && !T_odom_base) how = PoseInterpolation::kGeodesic;
  const Pose2 T_odom = T_odom_base.value_or(from.T_odom_base);
  return {stamp_s, interpolate(how, from, to, share, T_odom), T_odom};
}

Pose2 PosePath::at(std::size_t index, double offset_s) const {
  const bool goes_back = index + 1 == nodes_.size() || (offset_s < 0.0 && index > 0);
  if (nodes_.size() == 1) return nodes_.front().T_map_base;
  const PoseFix& from = nodes_[goes_back ? index - 1 : index];
  const PoseFix& to = nodes_[goes_back ? index : index + 1];
  const double span_s = to.stamp_s - from.stamp_s;
  if (!(span_s > 0.0)) return nodes_[index].T_map_base;
  const double share = std::clamp((nodes_[index].stamp_s + offset_s - from.stamp_s) / span_s, -kFurthest, kFurthest);
  return from.T_map_base * exp_se2(share * log_se2(between(from.T_map_base, to.T_map_base)));
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

}  // namespace gdtslam

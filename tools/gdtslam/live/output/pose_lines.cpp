#include "pose_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gdtslam {
namespace {

constexpr std::string_view kNothing = "null";

std::string to_json(const Pose2& pose) { return fmt::format("[{},{},{}]", pose.x_m, pose.y_m, pose.theta_rad); }

std::string to_json(const PoseCovariance& c) {
  return fmt::format("[{},{},{},{},{},{}]", c.xx, c.xy, c.xt, c.yy, c.yt, c.tt);
}

std::string tum_line(double stamp_s, const Pose2& pose) {
  return fmt::format("{:.6f} {:.9f} {:.9f} 0 0 0 {:.9f} {:.9f}\n", stamp_s, pose.x_m, pose.y_m,
                     std::sin(0.5 * pose.theta_rad), std::cos(0.5 * pose.theta_rad));
}

}  // namespace

PoseFormat parse_pose_format(std::string_view name) {
  const auto* const found = std::find(kPoseFormats.begin(), kPoseFormats.end(), name);
  return static_cast<PoseFormat>(found - kPoseFormats.begin());
}

std::string pose_line(PoseFormat format, std::uint64_t scan, const MappedScan& mapped) {
  const MatchResult& match = mapped.match;
  if (format == PoseFormat::kTum) return tum_line(match.stamp_s, mapped.T_closed_front * match.T_map_base);
  return fmt::format(
      "{{\"scan\":{},\"stamp_s\":{},\"pose\":{},\"covariance\":{},\"correction\":{},\"accepted\":{},\"keyframe\":{},"
      "\"doubt\":\"{}\",\"mean_distance_m\":{},\"overlap\":{},\"contradiction\":{}}}\n",
      scan, match.stamp_s, to_json(match.T_map_base),
      match.covariance ? to_json(*match.covariance) : std::string(kNothing), to_json(mapped.T_closed_front),
      match.accepted, match.merged, to_string(match.doubt), match.mean_cost_m, match.overlap, match.contradiction);
}

std::string pose_line(PoseFormat format, std::uint64_t scan, double stamp_s, const TrackedPose& pose) {
  const bool is_known = pose.whereabouts != Whereabouts::kUnknown;
  if (format == PoseFormat::kTum) return is_known ? tum_line(stamp_s, pose.T_map_base) : std::string();
  const std::string nothing(kNothing);
  return fmt::format(
      "{{\"scan\":{},\"stamp_s\":{},\"whereabouts\":\"{}\",\"pose\":{},\"covariance\":{},\"explained\":{},"
      "\"mean_distance_m\":{},\"ambiguous\":{}}}\n",
      scan, stamp_s, to_string(pose.whereabouts), is_known ? to_json(pose.T_map_base) : nothing,
      is_known ? to_json(pose.covariance) : nothing, is_known ? fmt::to_string(pose.explained) : nothing,
      is_known ? fmt::to_string(pose.mean_distance_m) : nothing, pose.is_ambiguous);
}

}  // namespace gdtslam

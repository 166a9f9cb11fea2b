#include "pose_lines.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

std::string json_of(const Pose2& pose) { return fmt::format("[{},{},{}]", pose.x_m, pose.y_m, pose.theta_rad); }

std::string json_line(std::uint64_t scan, const MatchResult& match, const Pose2& T_closed_front) {
  return fmt::format(
      "{{\"scan\":{},\"stamp_s\":{},\"pose\":{},\"correction\":{},\"accepted\":{},\"keyframe\":{},\"doubt\":\"{}\","
      "\"mean_distance_m\":{},\"overlap\":{},\"contradiction\":{}}}\n",
      scan, match.stamp_s, json_of(match.T_map_base), json_of(T_closed_front), match.accepted, match.merged,
      to_string(match.doubt), match.mean_cost_m, match.overlap, match.contradiction);
}

std::string tum_line(double stamp_s, const Pose2& pose) {
  return fmt::format("{:.6f} {:.9f} {:.9f} 0 0 0 {:.9f} {:.9f}\n", stamp_s, pose.x_m, pose.y_m,
                     std::sin(0.5 * pose.theta_rad), std::cos(0.5 * pose.theta_rad));
}

}  // namespace

void PoseLines::print(std::uint64_t scan, const MatchResult& match, const Pose2& T_closed_front) const {
  print_result(is_json_ ? json_line(scan, match, T_closed_front)
                        : tum_line(match.stamp_s, T_closed_front * match.T_map_base));
}

}  // namespace gdtslam

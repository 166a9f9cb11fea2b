#include "tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace gdtslam {

std::string json_name(Verdict verdict) {
  std::string name(to_string(verdict));
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string table_text(const std::vector<LocalizedScan>& scans) {
  std::string text =
      "scan,stamp_s,verdict,ambiguous,x_m,y_m,theta_rad,points,mean_distance_m,mean_bound_m,proven,elsewhere_x_m,"
      "elsewhere_y_m,elsewhere_theta_rad,elsewhere_mean_distance_m\n";
  const auto out = std::back_inserter(text);
  for (const LocalizedScan& scan : scans) {
    fmt::format_to(out, "{},{:.9f},{},{}", scan.index, scan.stamp_s, json_name(scan.verdict),
                   scan.is_ambiguous() ? 1 : 0);
    if (scan.best) {
      const Pose2& T = scan.best->T_map_base;
      fmt::format_to(out, ",{:.6f},{:.6f},{:.8f},{},{:.5f},{:.5f},{}", T.x_m, T.y_m, T.theta_rad, scan.points,
                     scan.best->mean_cost_m, scan.best->mean_bound_m, scan.is_proven() ? 1 : 0);
    } else {
      fmt::format_to(out, ",,,,{},,,0", scan.points);
    }
    if (scan.runner_up && scan.runner_up->stop != CertifiedStop::kNothingAllowed) {
      const Pose2& T = scan.runner_up->T_map_base;
      fmt::format_to(out, ",{:.6f},{:.6f},{:.8f},{:.5f}\n", T.x_m, T.y_m, T.theta_rad, scan.runner_up->mean_cost_m);
    } else {
      fmt::format_to(out, ",,,,\n");
    }
  }
  return text;
}

std::string table_text(const TrackedDrive& drive) {
  std::string text =
      "scan,stamp_s,whereabouts,ambiguous,x_m,y_m,theta_rad,xx_m2,xy_m2,xt_m_rad,yy_m2,yt_m_rad,tt_rad2,explained,"
      "mean_distance_m\n";
  const auto out = std::back_inserter(text);
  for (const TrackedScan& scan : drive.scans) {
    const TrackedPose& pose = scan.pose;
    fmt::format_to(out, "{},{:.9f},{},{}", scan.index, scan.stamp_s, to_string(pose.whereabouts),
                   pose.is_ambiguous ? 1 : 0);
    if (pose.whereabouts == Whereabouts::kUnknown) {
      fmt::format_to(out, ",,,,,,,,,,,\n");
      continue;
    }
    const Pose2& T = pose.T_map_base;
    const PoseCovariance& c = pose.covariance;
    fmt::format_to(out, ",{:.6f},{:.6f},{:.8f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4f},{:.5f}\n", T.x_m, T.y_m,
                   T.theta_rad, c.xx, c.xy, c.xt, c.yy, c.yt, c.tt, pose.explained, pose.mean_distance_m);
  }
  return text;
}

std::array<std::uint64_t, kVerdicts.size()> count_verdicts(const std::vector<LocalizedScan>& scans) {
  std::array<std::uint64_t, kVerdicts.size()> counts{};
  for (const LocalizedScan& scan : scans) ++counts.at(static_cast<std::size_t>(scan.verdict));
  return counts;
}

std::array<std::uint64_t, kWhereabouts.size()> count_whereabouts(const TrackedDrive& drive) {
  std::array<std::uint64_t, kWhereabouts.size()> counts{};
  for (const TrackedScan& scan : drive.scans) ++counts.at(static_cast<std::size_t>(scan.pose.whereabouts));
  return counts;
}

}  // namespace gdtslam

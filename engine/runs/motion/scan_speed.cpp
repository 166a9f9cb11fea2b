#include "scan_speed.hpp"

#include <algorithm>
#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kLongestSpan_s = 1.0;
constexpr double kFastest_m_per_s = 30.0;
constexpr double kFastestTurn_rad_per_s = 2.0 * kTwoPi;
constexpr std::size_t kMostTimedLasers = 64;

bool has_beam_times(const LaserScan& scan) { return scan.first_beam_after_s != 0.0 || scan.beam_period_s != 0.0; }

}  // namespace

std::optional<Eigen::Vector3d> speed_between(const Odometry& before, const Odometry& now) {
  const double span_s = now.stamp_s - before.stamp_s;
  if (!(span_s > 0.0 && span_s <= kLongestSpan_s)) return std::nullopt;
  const Eigen::Vector3d speed = log_se2(between(before.T_odom_base, now.T_odom_base)) / span_s;
  const bool is_possible = speed.head<2>().norm() <= kFastest_m_per_s && std::fabs(speed[2]) <= kFastestTurn_rad_per_s;
  return is_possible ? std::optional(speed) : std::nullopt;  // false for NaN too
}

void OdometrySpeed::complete(ScanRecord& scan) {
  if (!scan.T_odom_base || scan.laser >= kMostTimedLasers || !has_beam_times(scan.scan)) return;
  if (scan.laser >= before_.size()) before_.resize(scan.laser + 1);
  std::optional<Odometry>& before = before_[scan.laser];
  const Odometry now{scan.scan.stamp_s, *scan.T_odom_base};
  if (before && !scan.scan.speed) scan.scan.speed = speed_between(*before, now);
  before = now;
}

void MapSpeed::complete(ScanRecord& record) const {
  if (record.laser >= lasers_.size() || !has_beam_times(record.scan)) return;
  if (!record.scan.speed) record.scan.speed = lasers_[record.laser].speed;
}

void MapSpeed::take(const ScanRecord& record, const Pose2& T_map_base) {
  const LaserScan& scan = record.scan;
  if (record.laser >= kMostTimedLasers || !has_beam_times(scan)) return;
  if (record.laser >= lasers_.size()) lasers_.resize(record.laser + 1);
  const double beams = static_cast<double>(scan.ranges_m.size());
  const double middle_s = scan.first_beam_after_s + 0.5 * std::max(0.0, beams - 1.0) * scan.beam_period_s;
  const Pose2 T_map_middle = scan.speed ? T_map_base * exp_se2(middle_s * *scan.speed) : T_map_base;
  const Odometry now{scan.stamp_s + middle_s, T_map_middle};
  auto& [last, speed] = lasers_[record.laser];
  if (last && now.stamp_s == last->stamp_s) return;
  speed = last ? speed_between(*last, now) : std::nullopt;
  last = now;
}

}  // namespace gdtslam

#include "scanning_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include "engine/core/elementary.hpp"
#include "engine/core/quantile.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kSlope_s = 0.04;       ///< on each side: for the elevation's slope, well above one scan's time
constexpr double kSmooth_s = 1.5;       ///< on each side: for the camera's average
constexpr int kSmoothSteps = 12;        ///< on each side
constexpr std::size_t kSamples = 4000;  ///< points for estimates

bool is_before(const CloudPoint& point, double stamp_s) { return point.stamp_s < stamp_s; }
bool is_after(double stamp_s, const CloudPoint& point) { return stamp_s < point.stamp_s; }

double tangent(double angle_rad) {
  const SinCos<double> unit = sin_cos(angle_rad);
  return unit.sin / unit.cos;
}

Pose2 blended(const StampedPose& before, const StampedPose& after, double stamp_s) {
  if (!(after.stamp_s > before.stamp_s)) return before.T_map_base;
  const double share = std::clamp((stamp_s - before.stamp_s) / (after.stamp_s - before.stamp_s), 0.0, 1.0);
  const Pose2& a = before.T_map_base;
  const Pose2& b = after.T_map_base;
  return {a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m),
          wrap_angle(a.theta_rad + share * wrap_angle(b.theta_rad - a.theta_rad))};
}

}  // namespace

ScanningTrack::ScanningTrack(std::span<const CloudPoint> cloud, const Trajectory& trajectory, double from_s,
                             double to_s)
    : from_s_(from_s), to_s_(to_s) {
  assert(to_s > from_s);
  std::copy_if(cloud.begin(), cloud.end(), std::back_inserter(points_),
               [&](const CloudPoint& point) { return point.stamp_s >= from_s && point.stamp_s <= to_s; });
  assert(!points_.empty());
  std::stable_sort(points_.begin(), points_.end(),
                   [](const CloudPoint& a, const CloudPoint& b) { return a.stamp_s < b.stamp_s; });
  for (const StampedPose& pose : trajectory) {
    if (pose.T_map_base.is_finite() && std::isfinite(pose.stamp_s)) poses_.push_back(pose);
  }
  if (poses_.empty()) throw InputError("a film of the scanning needs the robot's path; the trajectory is empty");
  std::stable_sort(poses_.begin(), poses_.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.stamp_s < b.stamp_s; });
}

std::size_t ScanningTrack::count_until(double stamp_s) const {
  return static_cast<std::size_t>(std::upper_bound(points_.begin(), points_.end(), stamp_s, is_after) -
                                  points_.begin());
}

std::span<const CloudPoint> ScanningTrack::measured_between(double after_s, double until_s) const {
  const std::size_t first = count_until(after_s);
  const std::size_t last = std::max(first, count_until(until_s));
  return std::span<const CloudPoint>(points_).subspan(first, last - first);
}

std::span<const CloudPoint> ScanningTrack::last_scan(double stamp_s) const {
  std::size_t end = count_until(stamp_s);
  if (end == 0) return {};
  if (end < points_.size()) {
    // The scan in progress is not complete.
    const std::uint32_t running = points_[end].scan;
    while (end > 0 && points_[end - 1].scan == running) --end;
    if (end == 0) return {};
  }
  std::size_t begin = end;
  while (begin > 0 && points_[begin - 1].scan == points_[end - 1].scan) --begin;
  return std::span<const CloudPoint>(points_).subspan(begin, end - begin);
}

double ScanningTrack::elevation_rad(double stamp_s) const {
  const auto after = std::lower_bound(points_.begin(), points_.end(), stamp_s, is_before);
  if (after == points_.begin()) return after->elevation_rad;
  const CloudPoint& before = *(after - 1);
  if (after == points_.end()) return before.elevation_rad;
  const double gap_s = after->stamp_s - before.stamp_s;
  const double share = gap_s > 0.0 ? (stamp_s - before.stamp_s) / gap_s : 0.0;
  const double first_rad = before.elevation_rad;
  const double second_rad = after->elevation_rad;
  return wrap_angle(first_rad + share * wrap_angle(second_rad - first_rad));
}

bool ScanningTrack::is_rising(double stamp_s) const {
  return wrap_angle(elevation_rad(stamp_s + kSlope_s) - elevation_rad(stamp_s - kSlope_s)) >= 0.0;
}

Pose2 ScanningTrack::T_map_base(double stamp_s) const {
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), stamp_s,
                                      [](const StampedPose& pose, double time_s) { return pose.stamp_s < time_s; });
  if (after == poses_.begin()) return after->T_map_base;
  if (after == poses_.end()) return poses_.back().T_map_base;
  return blended(*(after - 1), *after, stamp_s);
}

Pose2 ScanningTrack::T_map_base_smooth(double stamp_s) const {
  Point2 place = Point2::Zero();
  Point2 heading = Point2::Zero();
  double weights = 0.0;
  for (int i = -kSmoothSteps; i <= kSmoothSteps; ++i) {
    const Pose2 pose = T_map_base(stamp_s + kSmooth_s * i / kSmoothSteps);
    const double weight = kSmoothSteps + 1 - std::abs(i);
    const SinCos<double> unit = sin_cos(pose.theta_rad);
    place += weight * pose.translation();
    heading += weight * Point2(unit.cos, unit.sin);
    weights += weight;
  }
  place /= weights;
  return {place.x(), place.y(), gdtslam::atan2(heading.y(), heading.x())};
}

double ScanningTrack::sensor_forward_m(const NoddingMount& mount) const {
  constexpr double kLeast_rad = 0.35;  // flatter planes are not informative
  constexpr double kMost_rad = 1.2;
  constexpr std::size_t kLeastSamples = 50;
  constexpr double kMostSpread_m = 0.1;
  if (mount.sensor_roll_rad != 0.0) return 0.0;
  std::vector<double> forward;
  const std::size_t step = std::max<std::size_t>(1, points_.size() / kSamples);
  for (std::size_t i = 0; i < points_.size(); i += step) {
    const CloudPoint& point = points_[i];
    const double tilt_rad = point.elevation_rad;
    if (std::fabs(tilt_rad) < kLeast_rad || std::fabs(tilt_rad) > kMost_rad) continue;
    const double above_m = static_cast<double>(point.z_m) - mount.height_m;
    const Point2 at = inverse(T_map_base(point.stamp_s)) * Point2(point.x_m, point.y_m);
    const Point3 moved = T_level_laser(mount, tilt_rad).translation_m;
    forward.push_back(at.x() - moved.x() - (above_m - moved.z()) / tangent(tilt_rad));
  }
  if (forward.size() < kLeastSamples) return 0.0;
  const bool agrees = value_at_share(forward, 0.75) - value_at_share(forward, 0.25) < kMostSpread_m;
  return agrees ? value_at_share(forward, 0.5) : 0.0;
}

double ScanningTrack::usual_range_m() const {
  std::vector<double> ranges_m;
  const std::size_t step = std::max<std::size_t>(1, points_.size() / kSamples);
  for (std::size_t i = 0; i < points_.size(); i += step) {
    const Point2 away = Point2(points_[i].x_m, points_[i].y_m) - T_map_base(points_[i].stamp_s).translation();
    ranges_m.push_back(std::sqrt(away.x() * away.x() + away.y() * away.y()));
  }
  return value_at_share(ranges_m, 0.5);
}

}  // namespace gdtslam

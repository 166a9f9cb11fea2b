#include "path_correction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/to_position.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kKnotStep_s = 0.5;
constexpr double kLongestGap_s = 1.0;  // a longer gap between scans, or a clock set back, counts as this

Point3 space_point(const Point2& point) { return {point.x(), point.y(), 0.0}; }

}  // namespace

PathCorrection::PathCorrection(PlanarPath path, double lowest_rad, double highest_rad)
    : elevation_knots_rad(kElevationKnots, 0.0),
      path_(std::move(path)),
      lowest_rad_(lowest_rad),
      elevation_step_rad_(std::max(highest_rad - lowest_rad, 1.0e-3) / static_cast<double>(kKnotsOfAStroke - 1)) {
  if (path_.strokes.empty()) path_.strokes.push_back({path_.first_scan, true});
  double now_s = 0.0;
  for (std::size_t k = 0; k < path_.poses.size(); ++k) {
    const double step_s = k == 0 ? 0.0 : path_.poses[k].stamp_s - path_.poses[k - 1].stamp_s;
    now_s += step_s >= 0.0 && step_s <= kLongestGap_s ? step_s : kLongestGap_s;
    scan_s_.push_back(k == 0 ? 0.0 : now_s);
    if (knot_s_.empty() || scan_s_.back() - knot_s_.back() >= kKnotStep_s) {
      knot_s_.push_back(scan_s_.back());
      moments_.push_back(planar_moment({k, k, 0.0}));
    }
  }
  knot_s_.push_back(std::max(scan_s_.back(), knot_s_.back()) + kKnotStep_s);  // all scans lie between two knots
  moments_.push_back(planar_moment({path_.poses.size() - 1, path_.poses.size() - 1, 0.0}));
  knots.assign(knot_s_.size(), Tangent3::Zero());
}

PathCorrection::Between PathCorrection::scans_around(double scan) const {
  const std::size_t last = path_.poses.size() - 1;
  const double place = std::clamp(scan - static_cast<double>(path_.first_scan), 0.0, static_cast<double>(last));
  const auto before = std::min(static_cast<std::size_t>(place), last);
  return {before, std::min(before + 1, last), place - static_cast<double>(before)};
}

PathCorrection::Moment PathCorrection::planar_moment(const Between& scans) const {
  const Pose2& from = path_.poses[scans.before].T_map_base;
  const Pose2& to = path_.poses[scans.after].T_map_base;
  const Pose2 pose{from.x_m + scans.share * (to.x_m - from.x_m), from.y_m + scans.share * (to.y_m - from.y_m),
                   from.theta_rad + scans.share * wrap_angle(to.theta_rad - from.theta_rad)};
  const PointMotion motion(pose);
  Moment moment;
  moment.centre = space_point(pose.translation());
  moment.left = space_point(motion.turned(Point2(0.0, 1.0)));
  moment.axis = space_point(motion(Point2(path_.axis_base_m.x(), path_.axis_base_m.y())));
  moment.axis.z() = path_.axis_base_m.z();
  return moment;
}

PathCorrection::Moment PathCorrection::at_scan(double scan) const {
  const Between scans = scans_around(scan);
  Moment moment = planar_moment(scans);
  const double now_s = scan_s_[scans.before] + scans.share * (scan_s_[scans.after] - scan_s_[scans.before]);
  const auto next = std::upper_bound(knot_s_.begin() + 1, knot_s_.end() - 1, now_s);
  const auto stroke =
      std::upper_bound(path_.strokes.begin() + 1, path_.strokes.end(), scan,
                       [](double wanted, const Stroke& one) { return wanted < static_cast<double>(one.first_scan); });
  moment.is_upward = (stroke - 1)->is_upward;
  moment.knot = static_cast<std::size_t>(next - knot_s_.begin()) - 1;
  moment.share = (now_s - knot_s_[moment.knot]) / step_s(moment.knot);
  return moment;
}

PathCorrection::ElevationPlace PathCorrection::at_elevation(double elevation_rad, bool is_upward) const {
  const double place =
      std::clamp((elevation_rad - lowest_rad_) / elevation_step_rad_, 0.0, static_cast<double>(kKnotsOfAStroke - 1));
  const auto knot = std::min(static_cast<std::size_t>(place), kKnotsOfAStroke - 2);
  return {knot + (is_upward ? 0 : kKnotsOfAStroke), place - static_cast<double>(knot)};
}

Tangent3 PathCorrection::correction(const Moment& moment) const {
  return (1.0 - moment.share) * knots[moment.knot] + moment.share * knots[moment.knot + 1];
}

double PathCorrection::lift_rad(double elevation_rad, const Moment& moment) const {
  const ElevationPlace place = at_elevation(elevation_rad, moment.is_upward);
  return (1.0 - place.share) * elevation_knots_rad[place.knot] + place.share * elevation_knots_rad[place.knot + 1];
}

Point3 PathCorrection::corrected(const Point3& point, double elevation_rad, const Moment& moment) const {
  const Tangent3 by = correction(moment);
  const Point3 lifted = moment.axis + exp_so3(-lift_rad(elevation_rad, moment) * moment.left) * (point - moment.axis);
  return moment.centre + by.head<3>() + exp_so3(by.tail<3>()) * (lifted - moment.centre);
}

// The correction is that of the scan's stamp, and changes by its rate over the scan. A lift is small: its first order
// is enough.
void PathCorrection::correct(std::span<CloudPoint> points) const {
  Moment moment;
  Tangent3 by = Tangent3::Zero();
  Tangent3 rate = Tangent3::Zero();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  double stamp_s = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    CloudPoint& point = points[k];
    if (k == 0 || point.scan != points[k - 1].scan) {
      moment = at_scan(static_cast<double>(point.scan));
      by = correction(moment);
      rate = (knots[moment.knot + 1] - knots[moment.knot]) / step_s(moment.knot);
      turn = rotation_matrix(exp_so3(by.tail<3>()));
      stamp_s = path_.poses[std::min<std::size_t>(point.scan - path_.first_scan, path_.poses.size() - 1)].stamp_s;
    }
    const Point3 measured = to_position(point);
    const double lift = lift_rad(static_cast<double>(point.elevation_rad), moment);
    const Point3 lifted = measured - lift * moment.left.cross(measured - moment.axis);
    const Point3 arm = turn * (lifted - moment.centre);
    const double after_s = point.stamp_s - stamp_s;
    const Point3 moved = moment.centre + by.head<3>() + arm + after_s * (rate.head<3>() + rate.tail<3>().cross(arm));
    point.x_m = static_cast<float>(moved.x());
    point.y_m = static_cast<float>(moved.y());
    point.z_m = static_cast<float>(moved.z());
  }
}

std::vector<Pose3> PathCorrection::poses() const {
  std::vector<Pose3> poses;
  poses.reserve(path_.poses.size());
  for (std::size_t k = 0; k < path_.poses.size(); ++k) {
    const Tangent3 by = correction(at_scan(static_cast<double>(path_.first_scan + k)));
    const Pose3 planar = embed(path_.poses[k].T_map_base);
    poses.push_back({planar.translation_m + by.head<3>(), (exp_so3(by.tail<3>()) * planar.rotation).normalized()});
  }
  return poses;
}

}  // namespace gdtslam

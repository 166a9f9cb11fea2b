#include "horizontal_scans.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/map/scan_beams.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kLongestStep_s = 0.5;  // longest time between two scans whose odometry gives the motion within one

/// The elevation at any time of a scan.
class ElevationCourse {
 public:
  ElevationCourse(const NoddingScan& scan, const ElevationTable& table) : knots_(scan.knots), table_(table) {}
  double at(double offset_s) {
    while (next_ + 1 < knots_.size() && knots_[next_].offset_s <= offset_s) ++next_;
    const PhaseKnot& from = knots_[next_ - 1];
    const PhaseKnot& to = knots_[next_];
    const double span_s = to.offset_s - from.offset_s;
    const double share = span_s > 0.0 ? std::clamp((offset_s - from.offset_s) / span_s, 0.0, 1.0) : 0.0;
    const auto turn = static_cast<double>(static_cast<std::int32_t>(to.phase - from.phase));
    return table_.elevation_rad(from.phase + static_cast<Phase>(std::llround(share * turn)));
  }

 private:
  const std::vector<PhaseKnot>& knots_;
  const ElevationTable& table_;
  std::size_t next_ = 1;
};

// Motion per second of the robot, from one scan to the next; zero without odometry.
Tangent2 estimate_velocity(const ScanRecord& record, const std::optional<Odometry>& before) {
  if (!before || !record.T_odom_base) return {};
  const double span_s = record.scan.stamp_s - before->stamp_s;
  if (!(span_s > 0.0 && span_s <= kLongestStep_s)) return {};
  const Tangent2 motion = log_tangent(between(before->T_odom_base, *record.T_odom_base));
  return {motion[0] / span_s, motion[1] / span_s, motion[2] / span_s};
}

Pose2 moved_for(const Tangent2& velocity, double time_s) {
  return exp_tangent({velocity[0] * time_s, velocity[1] * time_s, velocity[2] * time_s});
}

void widen(ElevationRange& range, double elevation_rad) {
  range.low_rad = std::min(range.low_rad, elevation_rad);
  range.high_rad = std::max(range.high_rad, elevation_rad);
}

ElevationRange elevation_range(const NoddingScan& scan, const ElevationTable& table) {
  ElevationRange range;
  for (const PhaseKnot& knot : scan.knots) widen(range, table.elevation_rad(knot.phase));
  return range;
}

std::string degrees(double angle_rad) {
  const double tenths = std::round(deg_from_rad(angle_rad) * 10.0) / 10.0;
  std::string text = std::to_string(tenths);
  return text.substr(0, text.find('.') + 2);
}

}  // namespace

PointScan level_points(const NoddingScan& scan, const NoddingScanner& scanner, const ScanConfig& valid,
                       const std::optional<Odometry>& before, const HeightBand& band) {
  const LaserScan& laser = scan.record.scan;
  const double limit_m = range_limit_m(laser, valid.max_range_m);
  const BeamTiming timing = scanner.timing(laser);
  const Tangent2 velocity = estimate_velocity(scan.record, before);
  ElevationCourse course(scan, scanner.table);
  const LevelTurn turn(scanner.mount);
  PointScan level{.stamp_s = laser.stamp_s, .points_base_m = {}};
  level.points_base_m.reserve(laser.ranges_m.size());
  for (std::size_t beam = 0; beam < laser.ranges_m.size(); ++beam) {
    const auto range_m = static_cast<double>(laser.ranges_m[beam]);
    if (!(range_m >= valid.min_range_m && range_m < limit_m)) continue;  // false for NaN too
    const double offset_s = timing.of_beam_s(beam);
    const auto bearing = beam_direction(laser, beam);
    const Pose3 T_level = turn.T_level_laser(course.at(offset_s));
    const Point3 point = T_level * Point3(range_m * bearing.cos, range_m * bearing.sin, 0.0);
    if (!(point.z() >= band.low_m && point.z() <= band.high_m)) continue;
    level.points_base_m.push_back(moved_for(velocity, offset_s) * (laser.T_base_laser * Point2(point.x(), point.y())));
  }
  return level;
}

LaserScan level_scan(const NoddingScan& scan, const NoddingScanner& scanner) {
  LaserScan level = scan.record.scan;
  level.speed.reset();
  const BeamTiming timing = scanner.timing(level);
  ElevationCourse course(scan, scanner.table);
  const LevelTurn mount(scanner.mount);
  for (std::size_t beam = 0; beam < level.ranges_m.size(); ++beam) {
    const auto bearing = beam_direction(level, beam);
    Pose3 turn = mount.T_level_laser(course.at(timing.of_beam_s(beam)));
    turn.translation_m = Point3::Zero();
    const Point3 direction = turn * Point3(bearing.cos, bearing.sin, 0.0);
    const double share = std::sqrt(direction.x() * direction.x() + direction.y() * direction.y());
    const double range_m = static_cast<double>(level.ranges_m[beam]);
    if (level.is_at_limit(range_m)) continue;  // no return stays none
    level.ranges_m[beam] = static_cast<float>(range_m * share);
  }
  return level;
}

HorizontalScans::HorizontalScans(const NoddingConfig& config, const NoddingScanner& scanner, const ScanConfig& valid)
    : horizontal_rad_(config.horizontal_rad), scanner_(scanner), valid_(valid) {}

// A stroke ends if the elevation reverses by more than the width of the horizontal tolerance.
void HorizontalScans::note_stroke(double elevation_rad) {
  if (!last_elevation_rad_) last_elevation_rad_ = elevation_rad;
  const double step = elevation_rad - *last_elevation_rad_;
  if (stroke_ != 0 && step * stroke_ >= 0.0) {
    last_elevation_rad_ = elevation_rad;
  } else if (std::fabs(step) > 2.0 * horizontal_rad_ || (stroke_ == 0 && step != 0.0)) {
    stroke_ = step > 0.0 ? 1 : -1;
    last_elevation_rad_ = elevation_rad;
    ++strokes_;
  }
}

std::optional<PointScan> HorizontalScans::take(const NoddingScan& scan) {
  std::optional<PointScan> level;
  if (!scan.knots.empty()) {
    const ElevationRange range = elevation_range(scan, scanner_.table);
    widen(seen_, range.low_rad);
    widen(seen_, range.high_rad);
    note_stroke(scanner_.table.elevation_rad(scan.knots.back().phase));
    is_elevation_known_ = true;
    if (range.low_rad >= -horizontal_rad_ && range.high_rad <= horizontal_rad_) {
      level = level_points(scan, scanner_, valid_, last_odometry_);
    }
  }
  if (scan.record.T_odom_base) last_odometry_ = Odometry{scan.record.scan.stamp_s, *scan.record.T_odom_base};
  return level;
}

void HorizontalScans::throw_none() const {
  if (!is_elevation_known_) {
    throw InputError("no scan has a known elevation: no ENCODER or TILT message covers one");
  }
  throw InputError("no scan is horizontal, so none can be placed: elevations go from " + degrees(seen_.low_rad) +
                   " to " + degrees(seen_.high_rad) + " deg, the tolerance nod.horizontal is " +
                   degrees(horizontal_rad_) + " deg; is the linkage the right one?");
}

std::optional<Pose2> SteadyOdometry::take(const std::optional<Pose2>& T_odom_base) {
  if (!T_odom_base || !T_odom_base->is_finite()) return std::nullopt;
  if (T_odom_last_) {
    const Pose2 step = between(*T_odom_last_, *T_odom_base);
    if (!(step.translation().norm() <= max_step_m_) || !step.is_finite()) {  // NaN too
      ++leaps_;
      T_steady_odom_ = T_steady_odom_.value_or(Pose2{}) * *T_odom_last_ * inverse(*T_odom_base);
    }
  }
  T_odom_last_ = T_odom_base;
  return T_steady_odom_ ? *T_steady_odom_ * *T_odom_base : *T_odom_base;
}

}  // namespace gdtslam

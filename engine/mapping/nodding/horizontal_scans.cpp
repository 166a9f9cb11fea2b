#include "horizontal_scans.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "level_scan.hpp"

namespace gdtslam {
namespace {

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

HorizontalScans::HorizontalScans(const NoddingConfig& config, const NoddingScanner& scanner, const ScanConfig& valid)
    : horizontal_rad_(config.horizontal_rad), scanner_(scanner), valid_(valid) {}

// A stroke ends where the elevation turns by more than the tolerance of horizontal is wide.
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

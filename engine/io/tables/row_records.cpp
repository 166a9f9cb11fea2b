#include "row_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr float kNoReturn_m = std::numeric_limits<float>::infinity();
constexpr double kMostLasers = 64.0;

constexpr std::array kSensorNumbers{TableNumber::kLaserX,   TableNumber::kLaserY,         TableNumber::kLaserTheta,
                                    TableNumber::kAngleMin, TableNumber::kAngleMax,       TableNumber::kAngleIncrement,
                                    TableNumber::kRangeMax, TableNumber::kFirstBeamAfter, TableNumber::kTimeIncrement};

/// The pose if all three numbers are given, none if none is.
std::optional<Pose2> pose_in(const TableRow& row, TableNumber x, TableNumber y, TableNumber theta) {
  if (!row[x] && !row[y] && !row[theta]) return std::nullopt;
  for (const TableNumber number : {x, y, theta}) {
    if (!row[number]) {
      throw MalformedRow(fmt::format("has no {}: a pose has {}, {} and {}", table_name(number), table_name(x),
                                     table_name(y), table_name(theta)));
    }
  }
  return Pose2{*row[x], *row[y], *row[theta]};
}

void require_finite(const TableRow& row) {
  for (std::size_t k = 0; k < kTableNumbers; ++k) {
    const std::optional<double>& value = row.numbers[k];
    const auto number = static_cast<TableNumber>(k);
    if (value && !std::isfinite(*value) && number != TableNumber::kRangeMax) {
      throw MalformedRow(fmt::format("has {} as its {}, which is not finite", *value, table_name(number)));
    }
  }
}

std::vector<float> mended_ranges(const std::vector<double>& ranges_m, RangeRepairs& repairs) {
  std::vector<float> mended;
  mended.reserve(ranges_m.size());
  for (const double range_m : ranges_m) {
    if (std::isnan(range_m)) ++repairs.not_a_number;
    if (range_m < 0.0) ++repairs.negative;
    mended.push_back(range_m >= 0.0 ? static_cast<float>(range_m) : kNoReturn_m);
  }
  return mended;
}

/// The nearest point of each bearing. A point in the laser itself is no return.
std::vector<float> ranges_of_points(const std::vector<double>& points_m, double first_rad, double step_rad,
                                    RangeRepairs& repairs) {
  if (points_m.size() % 2 != 0) throw MalformedRow("has points of an odd number of values: they are x and y in turn");
  std::vector<float> ranges_m(kPointBeams, kNoReturn_m);
  for (std::size_t k = 0; k + 1 < points_m.size(); k += 2) {
    const double x_m = points_m[k];
    const double y_m = points_m[k + 1];
    const double range_m = std::sqrt(x_m * x_m + y_m * y_m);
    if (!std::isfinite(range_m)) {
      if (std::isnan(range_m)) ++repairs.not_a_number;
      continue;
    }
    if (range_m == 0.0) continue;
    const double bearing_rad = atan2(y_m, x_m);
    const auto beam = static_cast<std::size_t>(std::llround((bearing_rad - first_rad) / step_rad)) % kPointBeams;
    ranges_m[beam] = std::min(ranges_m[beam], static_cast<float>(range_m));
  }
  return ranges_m;
}

}  // namespace

Pose2 RowRecords::mount() const {
  if (options_.T_base_laser) return *options_.T_base_laser;
  return pose_in(said_, TableNumber::kLaserX, TableNumber::kLaserY, TableNumber::kLaserTheta).value_or(Pose2{});
}

void RowRecords::set_bearings(LaserScan& scan) const {
  const std::optional<double> first_rad =
      options_.first_bearing_rad ? options_.first_bearing_rad : said_[TableNumber::kAngleMin];
  std::optional<double> step_rad =
      options_.bearing_step_rad ? options_.bearing_step_rad : said_[TableNumber::kAngleIncrement];
  const std::size_t beams = scan.ranges_m.size();
  const std::optional<double>& last_rad = said_[TableNumber::kAngleMax];
  if (!step_rad && first_rad && last_rad) {
    step_rad = beams < 2 ? 0.0 : (*last_rad - *first_rad) / static_cast<double>(beams - 1);
  }
  if (beams > 0 && (!first_rad || (!step_rad && beams > 1))) {
    throw MalformedRow(
        "has ranges, but neither it nor a row before it has angle_min and angle_increment (radians); "
        "add them, or state log.bearings");
  }
  scan.first_bearing_rad = first_rad.value_or(0.0);
  scan.bearing_step_rad = step_rad.value_or(0.0);
  if (std::fabs(scan.first_bearing_rad) > kTwoPi || std::fabs(scan.bearing_step_rad) > kPi) {
    throw MalformedRow(fmt::format("has angle_min {} and angle_increment {}, beyond one turn: they are in radians",
                                   scan.first_bearing_rad, scan.bearing_step_rad));
  }
  if (beams > 1 && scan.bearing_step_rad == 0.0) throw MalformedRow("has an angle_increment of 0 for several ranges");
}

ScanRecord RowRecords::make_scan(TableRow& row, RangeRepairs& repairs) {
  ScanRecord record;
  LaserScan& scan = record.scan;
  scan.stamp_s = *row[TableNumber::kStamp];
  const double limit_m = said_[TableNumber::kRangeMax].value_or(0.0);
  scan.max_range_m = options_.max_range_m.value_or(limit_m > 0.0 && std::isfinite(limit_m) ? limit_m : 0.0);
  if (row.has_points) {
    scan.bearing_step_rad = kTwoPi / kPointBeams;
    scan.first_bearing_rad = -kPi;
    scan.ranges_m = ranges_of_points(row.points_m, scan.first_bearing_rad, scan.bearing_step_rad, repairs);
  } else {
    scan.ranges_m = mended_ranges(row.ranges_m, repairs);
    set_bearings(scan);
    scan.first_beam_after_s = said_[TableNumber::kFirstBeamAfter].value_or(0.0);
    scan.beam_period_s = said_[TableNumber::kTimeIncrement].value_or(0.0);
    if (scan.bearing_step_rad < 0.0) turn_beams_round(scan);
  }
  scan.T_base_laser = mount();
  const double laser = row[TableNumber::kLaser].value_or(0.0);
  if (!(laser >= 0.0 && laser < kMostLasers) || laser != std::floor(laser)) {
    throw MalformedRow(fmt::format("has {} as its laser, which is no whole number from 0 to 63", laser));
  }
  record.laser = static_cast<std::size_t>(laser);
  return record;
}

std::vector<LogRecord> RowRecords::records(TableRow& row, RangeRepairs& repairs) {
  std::vector<LogRecord> records;
  if (row.name) records.emplace_back(Parameter{*row.name, row.value});
  require_finite(row);
  // An increment replaces an earlier angle_max, and the reverse.
  if (row[TableNumber::kAngleMax] && !row[TableNumber::kAngleIncrement]) said_[TableNumber::kAngleIncrement].reset();
  for (const TableNumber number : kSensorNumbers) {
    if (row[number]) said_[number] = row[number];
  }
  const std::optional<Pose2> pose = pose_in(row, TableNumber::kX, TableNumber::kY, TableNumber::kTheta);
  const bool has_scan = row.has_ranges || row.has_points;
  if (row.has_ranges && row.has_points) throw MalformedRow("has both ranges and points; give one of them");
  const bool is_said = has_scan || pose || row.ticks || row[TableNumber::kElevation];
  if (!is_said) {
    if (records.empty()) throw MalformedRow("has no ranges, points, odometry, ticks or elevation");
    return records;
  }
  if (!row[TableNumber::kStamp]) throw MalformedRow("has no stamp");
  const double stamp_s = *row[TableNumber::kStamp];
  if (row.ticks) records.emplace_back(Encoder{stamp_s, *row.ticks});
  if (row[TableNumber::kElevation]) records.emplace_back(Tilt{stamp_s, *row[TableNumber::kElevation]});
  if (has_scan) {
    ScanRecord scan = make_scan(row, repairs);
    scan.T_odom_base = pose;
    records.emplace_back(std::move(scan));
  } else if (pose) {
    records.emplace_back(Odometry{stamp_s, *pose});
  }
  return records;
}

}  // namespace gdtslam

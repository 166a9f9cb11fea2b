#include "table_log.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace gdtslam {
namespace {

/// The columns of a written CSV file, in their order.
enum CsvColumn : std::size_t {
  kStamp,
  kX,
  kY,
  kTheta,
  kLaser,
  kLaserX,
  kLaserY,
  kLaserTheta,
  kAngleMin,
  kAngleIncrement,
  kRangeMax,
  kFirstBeamAfter,
  kTimeIncrement,
  kTicks,
  kElevation,
  kName,
  kValue,
  kRanges,
  kCsvColumns
};
constexpr std::string_view kCsvHeader =
    "stamp,x,y,theta,laser,laser_x,laser_y,laser_theta,angle_min,angle_increment,range_max,first_beam_after,"
    "time_increment,ticks,elevation,name,value,ranges\n";

using CsvCells = std::array<std::string, kCsvColumns>;

std::string shortest(double value) { return fmt::format("{}", value); }

void fill_pose(CsvCells& cells, const Pose2& pose, std::size_t first) {
  cells[first] = shortest(pose.x_m);
  cells[first + 1] = shortest(pose.y_m);
  cells[first + 2] = shortest(pose.theta_rad);
}

std::string csv_text(std::string_view text) {
  if (text.find_first_of(",\" \t\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' || c == '\r' ? ' ' : c;  // a record is a line
  }
  return quoted + '"';
}

void fill_scan(CsvCells& cells, const ScanRecord& record) {
  const LaserScan& scan = record.scan;
  cells[kStamp] = shortest(scan.stamp_s);
  if (record.T_odom_base) fill_pose(cells, *record.T_odom_base, kX);
  cells[kLaser] = std::to_string(record.laser);
  fill_pose(cells, scan.T_base_laser, kLaserX);
  cells[kAngleMin] = shortest(scan.first_bearing_rad);
  cells[kAngleIncrement] = shortest(scan.bearing_step_rad);
  cells[kRangeMax] = shortest(scan.max_range_m);
  cells[kFirstBeamAfter] = shortest(scan.first_beam_after_s);
  cells[kTimeIncrement] = shortest(scan.beam_period_s);
  std::string& list = cells[kRanges];
  for (const float range_m : scan.ranges_m) fmt::format_to(std::back_inserter(list), "{} ", range_m);
  list.empty() ? void(list = "none") : list.pop_back();
}

void append_numbers(std::string& line, std::string_view key, std::initializer_list<double> numbers) {
  fmt::format_to(std::back_inserter(line), ",\"{}\":[{}]", key, fmt::join(numbers, ","));
}

void append_pose_of(std::string& line, std::string_view key, const Pose2& pose) {
  append_numbers(line, key, {pose.x_m, pose.y_m, pose.theta_rad});
}

std::string scan_line(const ScanRecord& record) {
  const LaserScan& scan = record.scan;
  std::string line = fmt::format("{{\"stamp\":{}", scan.stamp_s);
  if (record.T_odom_base) append_pose_of(line, "odom", *record.T_odom_base);
  append_pose_of(line, "mount", scan.T_base_laser);
  fmt::format_to(std::back_inserter(line), ",\"laser\":{},\"angle_min\":{},\"angle_increment\":{},\"range_max\":{}",
                 record.laser, scan.first_bearing_rad, scan.bearing_step_rad, scan.max_range_m);
  fmt::format_to(std::back_inserter(line), ",\"first_beam_after\":{},\"time_increment\":{},\"ranges\":[",
                 scan.first_beam_after_s, scan.beam_period_s);
  for (const float range_m : scan.ranges_m) {  // JSON has no infinity
    line += std::isfinite(range_m) ? fmt::format("{},", range_m) : "null,";
  }
  if (!scan.ranges_m.empty()) line.pop_back();
  return line + "]}\n";
}

std::string json_string(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

CsvLog::CsvLog(AtomicFile& file) : sink_(file) { sink_.write(kCsvHeader); }

void CsvLog::write(const LogRecord& record) {
  CsvCells cells;
  if (const auto* scan = std::get_if<ScanRecord>(&record)) {
    fill_scan(cells, *scan);
  } else if (const auto* odometry = std::get_if<Odometry>(&record)) {
    cells[kStamp] = shortest(odometry->stamp_s);
    fill_pose(cells, odometry->T_odom_base, kX);
  } else if (const auto* encoder = std::get_if<Encoder>(&record)) {
    cells[kStamp] = shortest(encoder->stamp_s);
    cells[kTicks] = std::to_string(encoder->ticks);
  } else if (const auto* tilt = std::get_if<Tilt>(&record)) {
    cells[kStamp] = shortest(tilt->stamp_s);
    cells[kElevation] = shortest(tilt->elevation_rad);
  } else if (const auto* parameter = std::get_if<Parameter>(&record)) {
    cells[kName] = csv_text(parameter->name);
    cells[kValue] = csv_text(parameter->value);
  }
  sink_.write(fmt::format("{}\n", fmt::join(cells, ",")));
}

void JsonLinesLog::write(const LogRecord& record) {
  std::string line;
  if (const auto* scan = std::get_if<ScanRecord>(&record)) {
    line = scan_line(*scan);
  } else if (const auto* odometry = std::get_if<Odometry>(&record)) {
    line = fmt::format("{{\"stamp\":{}", odometry->stamp_s);
    append_pose_of(line, "odom", odometry->T_odom_base);
    line += "}\n";
  } else if (const auto* encoder = std::get_if<Encoder>(&record)) {
    line = fmt::format("{{\"stamp\":{},\"ticks\":{}}}\n", encoder->stamp_s, encoder->ticks);
  } else if (const auto* tilt = std::get_if<Tilt>(&record)) {
    line = fmt::format("{{\"stamp\":{},\"elevation\":{}}}\n", tilt->stamp_s, tilt->elevation_rad);
  } else if (const auto* parameter = std::get_if<Parameter>(&record)) {
    line = fmt::format("{{\"name\":{},\"value\":{}}}\n", json_string(parameter->name), json_string(parameter->value));
  }
  sink_.write(line);
}

}  // namespace gdtslam

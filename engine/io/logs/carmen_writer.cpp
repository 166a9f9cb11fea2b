#include "carmen_writer.hpp"

#include <array>
#include <cassert>
#include <charconv>
#include <cmath>

#include "carmen.hpp"

namespace gdtslam {
namespace {

constexpr int kDecimals = 6;
constexpr int kBearingDecimals = 12;

// Below 0 decimals: as many as read back as the same number.
template <class Number>
void append_fixed(std::string& line, Number value, int decimals) {
  // The longest double in fixed notation has 309 digits before the point, the shortest form at most 1100 characters.
  std::array<char, 1200> text{};
  char* const end = text.data() + text.size();
  const std::to_chars_result result = decimals < 0
                                          ? std::to_chars(text.data(), end, value, std::chars_format::fixed)
                                          : std::to_chars(text.data(), end, value, std::chars_format::fixed, decimals);
  assert(result.ec == std::errc());
  line.append(text.data(), result.ptr);
}

}  // namespace

void CarmenWriter::append_field(std::string& line, double value) const {
  line += ' ';
  append_fixed(line, value, range_decimals_ < 0 ? kAsNeeded : kDecimals);
}

void CarmenWriter::append_bearing(std::string& line, double value) const {
  line += ' ';
  append_fixed(line, value, range_decimals_ < 0 ? kAsNeeded : kBearingDecimals);
}

void CarmenWriter::append_pose(std::string& line, const Pose2& pose) const {
  append_field(line, pose.x_m);
  append_field(line, pose.y_m);
  append_field(line, pose.theta_rad);
}

void CarmenWriter::append_stamp(std::string& line, double stamp_s) const {
  append_field(line, stamp_s);
  line += ' ';
  line += host_;
  append_field(line, stamp_s);
  line += '\n';
}

void CarmenWriter::append_ranges(std::string& line, const std::vector<float>& ranges_m) const {
  line += ' ' + std::to_string(ranges_m.size());
  for (const float range_m : ranges_m) {
    line += ' ';
    append_fixed(line, range_m, range_decimals_);
  }
}

// A reader knows the bearings of a FLASER line only by its number of beams.
bool CarmenWriter::is_told_by_beam_count(const LaserScan& scan) const {
  const double tolerance_rad = range_decimals_ < 0 ? 0.0 : 1e-9;
  const std::size_t beams = scan.ranges_m.size();
  const BearingRule rule = bearing_rule(beams);
  return (beams == 180 || beams == 181 || beams == 360 || beams == 361) &&
         std::fabs(rule.first_rad - scan.first_bearing_rad) <= tolerance_rad &&
         std::fabs(rule.step_rad - scan.bearing_step_rad) <= tolerance_rad;
}

std::string fixed_text(double value, int decimals) {
  std::string text;
  append_fixed(text, value, decimals);
  return text;
}

std::string CarmenWriter::parameter(std::string_view name, std::string_view value) const {
  std::string line = "PARAM ";
  line.append(name).append(" ").append(value);
  append_stamp(line, 0.0);
  return line;
}

CarmenWriter::Speeds CarmenWriter::move_to(double stamp_s, const Pose2& T_odom_base) {
  const double elapsed_s = stamp_s - last_stamp_s_;
  if (!has_last_) {
    has_last_ = true;
  } else if (elapsed_s > 0.0) {
    const Eigen::Vector3d moved = log_se2(between(T_odom_last_, T_odom_base));
    speeds_ = {moved.x() / elapsed_s, moved.z() / elapsed_s};
  }
  last_stamp_s_ = stamp_s;
  T_odom_last_ = T_odom_base;
  return speeds_;
}

std::string CarmenWriter::odometry(const Odometry& odometry) {
  const Speeds speeds = move_to(odometry.stamp_s, odometry.T_odom_base);
  std::string line = "ODOM";
  append_pose(line, odometry.T_odom_base);
  append_field(line, speeds.forward_m_per_s);
  append_field(line, speeds.turn_rad_per_s);
  append_field(line, 0.0);  // acceleration, which robots do not report
  append_stamp(line, odometry.stamp_s);
  return line;
}

std::string CarmenWriter::encoder(const Encoder& encoder) const {
  std::string line = "ENCODER " + std::to_string(encoder.ticks);
  append_stamp(line, encoder.stamp_s);
  return line;
}

std::string CarmenWriter::tilt(const Tilt& tilt) const {
  std::string line = "TILT";
  append_field(line, tilt.elevation_rad);
  append_stamp(line, tilt.stamp_s);
  return line;
}

std::string CarmenWriter::scan(const ScanRecord& record) {
  assert(record.T_odom_base);
  const LaserScan& scan = record.scan;
  const Pose2& T_odom_base = *record.T_odom_base;
  const Speeds speeds = move_to(scan.stamp_s, T_odom_base);
  const bool is_flaser = is_told_by_beam_count(scan);
  assert(record.laser < 2);
  std::string line =
      is_flaser ? (record.laser == 0 ? "FLASER" : "RLASER") : (record.laser == 0 ? "ROBOTLASER1 0" : "ROBOTLASER2 0");
  if (!is_flaser) {
    const auto steps = static_cast<double>(scan.ranges_m.empty() ? 0 : scan.ranges_m.size() - 1);
    append_bearing(line, scan.first_bearing_rad);
    append_bearing(line, steps * scan.bearing_step_rad);
    append_bearing(line, scan.bearing_step_rad);
    append_field(line, scan.max_range_m);
    line += " 0.010000 0";
  }
  append_ranges(line, scan.ranges_m);
  line += is_flaser ? "" : " 0";
  // Equal poses mean an identity mount; a product would have its angle wrapped.
  append_pose(line, scan.T_base_laser == Pose2{} ? T_odom_base : T_odom_base * scan.T_base_laser);
  append_pose(line, T_odom_base);
  if (!is_flaser) {
    append_field(line, speeds.forward_m_per_s);
    append_field(line, speeds.turn_rad_per_s);
    line += " 0.000000 0.000000 0.000000";
  }
  append_stamp(line, scan.stamp_s);
  return line;
}

}  // namespace gdtslam

#include "log_copy_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

namespace gdtslam {
namespace {

enum class RecordTag : std::uint8_t { kScan, kOdometry, kEncoder, kTilt, kParameter };
constexpr std::uint8_t kHasOdometry = 1;
constexpr std::uint8_t kHasScanSpeed = 2;
constexpr std::uint8_t kNewLaser = 4;
constexpr std::uint8_t kAllScanFlags = 7;
constexpr std::uint8_t kInMm = 0;  // how the ranges of a scan are written
constexpr std::uint8_t kAsTheyAre = 1;

constexpr double kMmOfMetre = 1000.0;
constexpr float kFarthestInMm =
    1.0e6F;  // metres, of which twice the step has 31 bits; what is farther away is written as it is
constexpr std::uint64_t kMostLaserNumber = 1U << 16U;
constexpr std::uint32_t kMostWarnings = 128;

void append_se2(BytesOut& out, const Pose2& pose) { out.number(pose.x_m).number(pose.y_m).number(pose.theta_rad); }

Pose2 se2_from(BytesIn& in) {
  const double x_m = in.number("a pose");
  const double y_m = in.number("a pose");
  return {x_m, y_m, in.number("a pose")};
}

std::array<double, 8> laser_of(const LaserScan& scan) {
  return {scan.first_bearing_rad, scan.bearing_step_rad, scan.max_range_m,      scan.first_beam_after_s,
          scan.beam_period_s,     scan.T_base_laser.x_m, scan.T_base_laser.y_m, scan.T_base_laser.theta_rad};
}

void set_laser(LaserScan& scan, const std::array<double, 8>& laser) {
  scan.first_bearing_rad = laser[0];
  scan.bearing_step_rad = laser[1];
  scan.max_range_m = laser[2];
  scan.first_beam_after_s = laser[3];
  scan.beam_period_s = laser[4];
  scan.T_base_laser = {laser[5], laser[6], laser[7]};
}

float metres_of_mm(std::int64_t mm) { return static_cast<float>(static_cast<double>(mm) / kMmOfMetre); }

// Zero and the float itself, or one more than the step from the last range in millimetres, where these are the same
// float again. Nothing where that is of no use because most are no whole millimetres. A scan has hundreds of them, so
// they are put where there is room for the longest.
std::optional<std::string_view> ranges_in_mm(const std::vector<float>& ranges_m, std::vector<char>& room) {
  constexpr std::size_t kLongest = 5;
  room.resize(std::max(room.size(), ranges_m.size() * kLongest));
  char* to = room.data();
  std::int64_t last_mm = 0;
  std::size_t left_as_they_are = 0;
  for (const float range_m : ranges_m) {
    const bool is_near = range_m >= 0.0F && range_m < kFarthestInMm;  // false for NaN too
    const auto mm = is_near ? static_cast<std::int64_t>(static_cast<double>(range_m) * kMmOfMetre + 0.5) : 0;
    const auto bits = std::bit_cast<std::uint32_t>(range_m);
    if (std::bit_cast<std::uint32_t>(metres_of_mm(mm)) != bits) {
      if (++left_as_they_are * 2 > ranges_m.size()) return std::nullopt;
      *to++ = 0;
      for (unsigned shift = 0; shift < 32U; shift += 8U) *to++ = static_cast<char>(bits >> shift & 0xffU);
      continue;
    }
    const std::int64_t step = mm - last_mm;
    auto coded = static_cast<std::uint32_t>((step < 0 ? -step : step) * 2 + (step < 0 ? 2 : 1));
    for (; coded >= 0x80U; coded >>= 7U) *to++ = static_cast<char>((coded & 0x7fU) | 0x80U);
    *to++ = static_cast<char>(coded);
    last_mm = mm;
  }
  return std::string_view(room.data(), static_cast<std::size_t>(to - room.data()));
}

void append_ranges(BytesOut& out, const std::vector<float>& ranges_m, std::vector<char>& room) {
  out.whole(static_cast<std::uint32_t>(ranges_m.size()));
  if (const std::optional<std::string_view> in_mm = ranges_in_mm(ranges_m, room)) {
    out.byte(kInMm).text(*in_mm);
    return;
  }
  out.byte(kAsTheyAre);
  for (const float range_m : ranges_m) out.whole(std::bit_cast<std::uint32_t>(range_m));
}

float range_from(BytesIn& in, std::int64_t& last_mm) {
  const std::uint64_t coded = in.varint();
  if (coded == 0) return std::bit_cast<float>(in.whole());
  const auto length = static_cast<std::int64_t>((coded - 1U) >> 1U);
  last_mm += ((coded - 1U) & 1U) != 0 ? -length : length;
  if (last_mm < 0 || !(metres_of_mm(last_mm) < kFarthestInMm)) {
    in.refuse(fmt::format("has a range of {} mm", last_mm));
  }
  return metres_of_mm(last_mm);
}

std::vector<float> scan_ranges_from(BytesIn& in) {
  const std::uint32_t beams = in.count("beams", 1);
  const std::uint8_t form = in.byte();
  if (form > kAsTheyAre) in.refuse(fmt::format("has ranges of form {}, which nothing is known of", form));
  const bool are_raw = form == kAsTheyAre;
  std::vector<float> ranges_m;
  ranges_m.reserve(beams);
  std::int64_t last_mm = 0;
  for (std::uint32_t beam = 0; beam < beams; ++beam) {
    const float range_m = are_raw ? std::bit_cast<float>(in.whole()) : range_from(in, last_mm);
    if (!(range_m >= 0.0F)) in.refuse("has a range below zero or one that is not a number");
    ranges_m.push_back(range_m);
  }
  return ranges_m;
}

void append_text(BytesOut& out, const std::string& text) {
  out.whole(static_cast<std::uint32_t>(text.size())).text(text);
}

std::string text_from(BytesIn& in) { return in.text(in.count("characters", 1)); }

Encoder encoder_from(BytesIn& in) {
  const double stamp_s = in.number("a stamp");
  const std::uint64_t low = in.whole();
  return {stamp_s, static_cast<std::int64_t>(low | static_cast<std::uint64_t>(in.whole()) << 32U)};
}

}  // namespace

void RecordCoder::append_scan(BytesOut& out, const ScanRecord& record) {
  const LaserScan& scan = record.scan;
  const Laser laser = laser_of(scan);
  const bool is_new = !laser_ || std::bit_cast<std::array<std::uint64_t, 8>>(laser) !=
                                     std::bit_cast<std::array<std::uint64_t, 8>>(*laser_);
  out.byte(static_cast<std::uint8_t>(RecordTag::kScan));
  out.byte(static_cast<std::uint8_t>((record.T_odom_base ? kHasOdometry : 0U) | (scan.speed ? kHasScanSpeed : 0U) |
                                     (is_new ? kNewLaser : 0U)));
  out.number(scan.stamp_s).varint(record.laser);
  if (record.T_odom_base) append_se2(out, *record.T_odom_base);
  if (scan.speed) out.number(scan.speed->x()).number(scan.speed->y()).number(scan.speed->z());
  if (is_new) {
    for (const double value : laser) out.number(value);
  }
  laser_ = laser;
  append_ranges(out, scan.ranges_m, room_);
}

ScanRecord RecordCoder::scan_from(BytesIn& in) {
  ScanRecord record;
  const std::uint8_t flags = in.byte();
  if ((flags & ~kAllScanFlags) != 0) in.refuse(fmt::format("has flags {} that nothing is known of", flags));
  record.scan.stamp_s = in.number("a stamp");
  const std::uint64_t laser = in.varint();
  if (laser > kMostLaserNumber) in.refuse(fmt::format("has a scan of laser {}", laser));
  record.laser = static_cast<std::size_t>(laser);
  if ((flags & kHasOdometry) != 0) record.T_odom_base = se2_from(in);
  if ((flags & kHasScanSpeed) != 0) {
    const double x = in.number("a speed");
    const double y = in.number("a speed");
    record.scan.speed.emplace(x, y, in.number("a speed"));
  }
  if ((flags & kNewLaser) != 0) {
    laser_.emplace();
    for (double& value : *laser_) value = in.number("a laser");
  }
  if (!laser_) in.refuse("has a scan before its laser");
  set_laser(record.scan, *laser_);
  record.scan.ranges_m = scan_ranges_from(in);
  return record;
}

void RecordCoder::append(BytesOut& out, const LogRecord& record) {
  if (const auto* scan = std::get_if<ScanRecord>(&record)) {
    append_scan(out, *scan);
  } else if (const auto* odometry = std::get_if<Odometry>(&record)) {
    out.byte(static_cast<std::uint8_t>(RecordTag::kOdometry)).number(odometry->stamp_s);
    append_se2(out, odometry->T_odom_base);
  } else if (const auto* encoder = std::get_if<Encoder>(&record)) {
    const auto ticks = static_cast<std::uint64_t>(encoder->ticks);
    out.byte(static_cast<std::uint8_t>(RecordTag::kEncoder)).number(encoder->stamp_s);
    out.whole(static_cast<std::uint32_t>(ticks)).whole(static_cast<std::uint32_t>(ticks >> 32U));
  } else if (const auto* tilt = std::get_if<Tilt>(&record)) {
    out.byte(static_cast<std::uint8_t>(RecordTag::kTilt)).number(tilt->stamp_s).number(tilt->elevation_rad);
  } else if (const auto* parameter = std::get_if<Parameter>(&record)) {
    out.byte(static_cast<std::uint8_t>(RecordTag::kParameter));
    append_text(out, parameter->name);
    append_text(out, parameter->value);
  }
}

LogRecord RecordCoder::record_from(BytesIn& in) {
  const std::uint8_t tag = in.byte();
  switch (static_cast<RecordTag>(tag)) {
    case RecordTag::kScan:
      return scan_from(in);
    case RecordTag::kOdometry: {
      const double stamp_s = in.number("a stamp");
      return Odometry{stamp_s, se2_from(in)};
    }
    case RecordTag::kEncoder:
      return encoder_from(in);
    case RecordTag::kTilt: {
      const double stamp_s = in.number("a stamp");
      return Tilt{stamp_s, in.number("an elevation")};
    }
    case RecordTag::kParameter: {
      std::string name = text_from(in);
      return Parameter{std::move(name), text_from(in)};
    }
  }
  in.refuse(fmt::format("has a record of kind {}, which nothing is known of", tag));
}

void append_end(BytesOut& out, const LogCopyEnd& end) {
  out.byte(end.is_whole ? 1U : 0U).whole(static_cast<std::uint32_t>(end.warnings.size()));
  for (const LogReader::Warning& warning : end.warnings) {
    append_text(out, warning.kind);
    out.whole(static_cast<std::uint32_t>(warning.count)).whole(static_cast<std::uint32_t>(warning.count >> 32U));
    append_text(out, warning.first);
  }
}

LogCopyEnd end_from(BytesIn& in) {
  LogCopyEnd end;
  const std::uint8_t is_whole = in.byte();
  if (is_whole > 1) in.refuse(fmt::format("has flags {} that nothing is known of", is_whole));
  end.is_whole = is_whole == 1;
  const std::uint32_t count = in.count("warnings", 16);
  if (count > kMostWarnings) in.refuse(fmt::format("has {} kinds of warnings", count));
  end.warnings.reserve(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    LogReader::Warning warning;
    warning.kind = text_from(in);
    const std::uint64_t low = in.whole();
    warning.count = low | static_cast<std::uint64_t>(in.whole()) << 32U;
    warning.first = text_from(in);
    end.warnings.push_back(std::move(warning));
  }
  if (in.left() > 0) in.refuse("goes on behind its end");
  return end;
}

std::string record_bytes(const LogRecord& record) {
  BytesOut out;
  RecordCoder().append(out, record);
  return out.take();
}

std::optional<double> stamp_of(const LogRecord& record) {
  if (const auto* scan = std::get_if<ScanRecord>(&record)) return scan->scan.stamp_s;
  if (const auto* odometry = std::get_if<Odometry>(&record)) return odometry->stamp_s;
  if (const auto* encoder = std::get_if<Encoder>(&record)) return encoder->stamp_s;
  if (const auto* tilt = std::get_if<Tilt>(&record)) return tilt->stamp_s;
  return std::nullopt;
}

}  // namespace gdtslam

// Copies of logs: what is written is read back bit for bit, whatever the records; cut at any byte there is what was
// whole; and a copy that is gone on with is the one that was never cut.
#include "engine/io/binary/log_copy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "engine/io/binary/log_copy_writer.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

class LogCopyTest : public testing::Test {
 protected:
  [[nodiscard]] std::string file(const char* name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
};

ScanRecord scan_at(double stamp_s, std::vector<float> ranges_m) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.scan.first_bearing_rad = -1.5;
  record.scan.bearing_step_rad = 0.017;
  record.scan.max_range_m = 81.83;
  record.scan.T_base_laser = {0.1, -0.02, 3.0e-7};
  record.scan.ranges_m = std::move(ranges_m);
  return record;
}

// Every kind of record, and of a scan every part at its limits.
std::vector<LogRecord> all_kinds() {
  constexpr float kFarAway = std::numeric_limits<float>::infinity();
  std::vector<LogRecord> records;
  records.push_back(Parameter{"robot_front_laser_max", "81.83"});
  records.push_back(Parameter{"", std::string("a\0b\n\xff", 5)});
  records.push_back(Odometry{0.1 + 0.2, {1.0 / 3.0, -0.0, 5.0e-324}});
  records.push_back(Encoder{1.5, std::numeric_limits<std::int64_t>::min()});
  records.push_back(Encoder{-1.5, std::numeric_limits<std::int64_t>::max()});
  records.push_back(Encoder{0.0, -1});
  records.push_back(Tilt{1.0e300, -0.25});
  records.push_back(scan_at(0.2, {}));
  records.push_back(scan_at(0.3, {0.0F, 1.234F, 1.2340001F, 81.83F, kFarAway, 0.001F, 999999.9F, 1.0e7F, 3.0e38F}));
  records.push_back(scan_at(0.4, {1.00037F, 1.00041F, 1.00052F, 2.0F}));  // most are no whole millimetres
  ScanRecord scan = scan_at(-7.0, {5.0F, -0.0F});
  scan.T_odom_base = Pose2{1.0, 2.0, -3.0};
  scan.scan.speed.emplace(0.5, 0.0, -0.1);
  scan.scan.first_beam_after_s = -0.05;
  scan.scan.beam_period_s = -1.0e-5;
  scan.laser = 3;
  records.push_back(scan);
  return records;
}

// A drive: several frames, ranges of whole millimetres and others.
std::vector<LogRecord> drive(std::size_t scans) {
  std::vector<LogRecord> records;
  records.reserve(2 * scans);
  for (std::size_t i = 0; i < scans; ++i) {
    const double stamp_s = 100.0 + 0.2 * static_cast<double>(i);
    records.push_back(Odometry{stamp_s - 0.01, {0.01 * static_cast<double>(i), 0.0, 0.0}});
    std::vector<float> ranges_m;
    ranges_m.reserve(90);
    for (int beam = 0; beam < 90; ++beam) {
      const double range_m = 3.0 + static_cast<double>((37 * static_cast<std::size_t>(beam) + 11 * i) % 1000) / 1000.0;
      ranges_m.push_back(static_cast<float>(beam % 7 == 0 ? range_m / 3.0 : range_m));
    }
    records.push_back(scan_at(stamp_s, std::move(ranges_m)));
  }
  return records;
}

void write_copy(const std::string& path, const std::vector<LogRecord>& records, const LogCopyEnd& end) {
  LogCopyWriter writer;
  writer.write_into(path);
  for (const LogRecord& record : records) writer.add(record);
  writer.end(end);
}

std::vector<LogRecord> records_of(LogReader& reader) {
  std::vector<LogRecord> records;
  while (std::optional<LogRecord> record = reader.next()) records.push_back(std::move(*record));
  return records;
}

bool is_same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool is_same_pose(const Pose2& a, const Pose2& b) {
  return is_same_bits(a.x_m, b.x_m) && is_same_bits(a.y_m, b.y_m) && is_same_bits(a.theta_rad, b.theta_rad);
}

bool is_same_scan(const ScanRecord& a, const ScanRecord& b) {
  const LaserScan& s = a.scan;
  const LaserScan& t = b.scan;
  bool same = a.laser == b.laser && a.T_odom_base.has_value() == b.T_odom_base.has_value() &&
              s.speed.has_value() == t.speed.has_value() && s.ranges_m.size() == t.ranges_m.size();
  if (!same) return false;
  same = is_same_bits(s.stamp_s, t.stamp_s) && is_same_bits(s.first_bearing_rad, t.first_bearing_rad) &&
         is_same_bits(s.bearing_step_rad, t.bearing_step_rad) && is_same_bits(s.max_range_m, t.max_range_m) &&
         is_same_bits(s.first_beam_after_s, t.first_beam_after_s) && is_same_bits(s.beam_period_s, t.beam_period_s) &&
         is_same_pose(s.T_base_laser, t.T_base_laser);
  if (a.T_odom_base) same = same && is_same_pose(*a.T_odom_base, *b.T_odom_base);
  if (s.speed) same = same && *s.speed == *t.speed;
  for (std::size_t k = 0; k < s.ranges_m.size(); ++k) {
    same = same && std::bit_cast<std::uint32_t>(s.ranges_m[k]) == std::bit_cast<std::uint32_t>(t.ranges_m[k]);
  }
  return same;
}

// Field by field, without the coder.
bool is_same_record(const LogRecord& a, const LogRecord& b) {
  if (a.index() != b.index()) return false;
  if (const auto* scan = std::get_if<ScanRecord>(&a)) return is_same_scan(*scan, std::get<ScanRecord>(b));
  if (const auto* odometry = std::get_if<Odometry>(&a)) {
    const auto& other = std::get<Odometry>(b);
    return is_same_bits(odometry->stamp_s, other.stamp_s) && is_same_pose(odometry->T_odom_base, other.T_odom_base);
  }
  if (const auto* encoder = std::get_if<Encoder>(&a)) {
    return is_same_bits(encoder->stamp_s, std::get<Encoder>(b).stamp_s) && encoder->ticks == std::get<Encoder>(b).ticks;
  }
  if (const auto* tilt = std::get_if<Tilt>(&a)) {
    return is_same_bits(tilt->stamp_s, std::get<Tilt>(b).stamp_s) &&
           is_same_bits(tilt->elevation_rad, std::get<Tilt>(b).elevation_rad);
  }
  const auto& parameter = std::get<Parameter>(a);
  return parameter.name == std::get<Parameter>(b).name && parameter.value == std::get<Parameter>(b).value;
}

void expect_begins_with(const std::vector<LogRecord>& all, const std::vector<LogRecord>& first) {
  ASSERT_LE(first.size(), all.size());
  for (std::size_t k = 0; k < first.size(); ++k) EXPECT_TRUE(is_same_record(all[k], first[k])) << "record " << k;
}

TEST_F(LogCopyTest, RecordsAndWarningsComeBackBitForBit) {
  const std::vector<LogRecord> records = all_kinds();
  write_copy(file("a"), records, {true, {{"backward stamp", 5'000'000'000, "a.log:7: file order is kept"}}});
  const auto reader = open_log(file("a"), {});
  const std::vector<LogRecord> read = records_of(*reader);
  EXPECT_EQ(read.size(), records.size());
  expect_begins_with(records, read);
  ASSERT_EQ(reader->warnings().size(), 1U);
  EXPECT_EQ(reader->warnings()[0].kind, "backward stamp");
  EXPECT_EQ(reader->warnings()[0].count, 5'000'000'000U);
  EXPECT_EQ(reader->warnings()[0].first, "a.log:7: file order is kept");
}

TEST_F(LogCopyTest, WhatIsStatedBesideTheLogCounts) {
  write_copy(file("a"), {scan_at(1.0, {2.0F})}, {true, {}});
  const auto reader = open_log(file("a"), {.max_range_m = 30.0, .T_base_laser = Pose2{1.0, 0.0, 0.0}});
  const auto scan = std::get<ScanRecord>(reader->next().value()).scan;
  EXPECT_EQ(scan.max_range_m, 30.0);
  EXPECT_EQ(scan.T_base_laser.x_m, 1.0);
  EXPECT_EQ(scan.first_bearing_rad, -1.5);
}

// What is whole before the cut is there, whatever byte the cut is at; and gone on with behind it, the copy is the same
// bytes as the one that was never cut.
TEST_F(LogCopyTest, CutAtAnyByteItIsGoneOnWith) {
  const std::vector<LogRecord> records = drive(60);
  write_copy(file("whole"), records, {true, {}});
  const std::string whole = get_file(file("whole"));
  std::size_t most = 0;
  for (std::size_t size = 0; size < whole.size(); size += size < 150 || size + 50 > whole.size() ? 1U : 49U) {
    put_file(file("cut"), whole.substr(0, size));
    const LogCopyExtent extent = extent_of_log_copy(file("cut"));
    EXPECT_LE(extent.whole_bytes, size);
    EXPECT_FALSE(extent.is_of_whole_log());
    EXPECT_GE(extent.records, most);  // a longer piece has no fewer
    most = extent.records;
    if (size >= kLogCopyHeadBytes) {
      const auto reader = open_log(file("cut"), {});
      const std::vector<LogRecord> read = records_of(*reader);
      EXPECT_EQ(read.size(), extent.records);
      expect_begins_with(records, read);
      ASSERT_EQ(reader->warnings().size(), 1U);
      EXPECT_EQ(reader->warnings()[0].kind, "cut log copy");
    }
    LogCopyWriter writer;
    writer.go_on_with(file("cut"), extent.sure_bytes);
    for (std::size_t k = extent.sure_records; k < records.size(); ++k) writer.add(records[k]);
    writer.end({true, {}});
    ASSERT_EQ(get_file(file("cut")), whole) << "cut at byte " << size;
  }
  EXPECT_EQ(most, records.size());
}

// A run that ended early wrote a frame that is shorter than it would have been.
TEST_F(LogCopyTest, EndedEarlyItIsGoneOnWith) {
  const std::vector<LogRecord> records = drive(100);
  write_copy(file("whole"), records, {true, {}});
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{60}, std::size_t{177}}) {
    write_copy(file("early"), {records.begin(), records.begin() + static_cast<std::ptrdiff_t>(count)}, {false, {}});
    const LogCopyExtent extent = extent_of_log_copy(file("early"));
    EXPECT_EQ(extent.records, count);
    EXPECT_FALSE(extent.is_of_whole_log());
    EXPECT_TRUE(extent.end.has_value());
    LogCopyWriter writer;
    writer.go_on_with(file("early"), extent.sure_bytes);
    for (std::size_t k = extent.sure_records; k < records.size(); ++k) writer.add(records[k]);
    writer.end({true, {}});
    EXPECT_EQ(get_file(file("early")), get_file(file("whole"))) << count << " records";
  }
}

// Each byte changed: an error, or with --lenient an end, and never another record.
TEST_F(LogCopyTest, DamageIsFound) {
  const std::vector<LogRecord> records = drive(60);
  write_copy(file("whole"), records, {true, {}});
  const std::string whole = get_file(file("whole"));
  for (std::size_t at = kLogCopyHeadBytes; at < whole.size(); at += 37) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    put_file(file("damaged"), damaged);
    const auto reader = open_log(file("damaged"), {.lenient = true});
    const std::vector<LogRecord> read = records_of(*reader);
    expect_begins_with(records, read);
    EXPECT_EQ(reader->warnings().size(), 1U) << "byte " << at;
    EXPECT_FALSE(extent_of_log_copy(file("damaged")).is_of_whole_log());
  }
}

std::string refusal_of(const std::string& path) {
  return told_by<InputError>([&] { records_of(*open_log(path, {})); });
}

TEST_F(LogCopyTest, RefusalsSayWhatIsWrong) {
  write_copy(file("a"), drive(3), {true, {}});
  const std::string whole = get_file(file("a"));
  std::string other = whole;
  other[kLogCopyMagic.size()] = 9;
  put_file(file("a"), other);
  EXPECT_THAT(refusal_of(file("a")), HasSubstr("log copy of version 9"));
  put_file(file("a"), whole + "more");
  EXPECT_THAT(refusal_of(file("a")), testing::IsEmpty());  // a frame that was begun
  put_file(file("a"), whole + whole.substr(kLogCopyHeadBytes));
  EXPECT_THAT(refusal_of(file("a")), HasSubstr("goes on behind its end"));
  std::string damaged = whole;
  damaged[kLogCopyHeadBytes + kLogCopyFrameBytes + 3] ^= 1;
  put_file(file("a"), damaged);
  EXPECT_THAT(refusal_of(file("a")), HasSubstr("at byte 20: has a frame whose checksum is that of other bytes"));
  std::string huge = whole;
  huge[kLogCopyHeadBytes + 3] = 0x7f;
  put_file(file("a"), huge);
  EXPECT_THAT(refusal_of(file("a")), HasSubstr("more than 64 MiB"));
}

// Until it is known where the copy goes it is kept.
TEST_F(LogCopyTest, FileMayComeLater) {
  const std::vector<LogRecord> records = drive(100);
  write_copy(file("at_once"), records, {true, {}});
  LogCopyWriter writer;
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (k == 120) writer.write_into(file("later"));
    writer.add(records[k]);
  }
  writer.end({true, {}});
  EXPECT_EQ(get_file(file("later")), get_file(file("at_once")));
}

}  // namespace
}  // namespace gdtslam

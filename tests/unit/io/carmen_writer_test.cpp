// Lines of CARMEN by docs/formats.md, letter by letter: decimals, speeds, which kind of line a scan becomes.
#include "engine/io/logs/carmen_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/io/writers/log_writer.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/io/log.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

ScanRecord carmen_scan(std::size_t beams, double first_rad, double step_rad) {
  ScanRecord record;
  record.scan.stamp_s = 2.0;
  record.scan.first_bearing_rad = first_rad;
  record.scan.bearing_step_rad = step_rad;
  record.scan.ranges_m.assign(beams, 1.5F);
  record.T_odom_base = Pose2{1.0, 2.0, 0.0};
  return record;
}

TEST(CarmenWriter, AsNeededIsTheShortestThatReadsBack) {
  CarmenWriter writer(CarmenWriter::kAsNeeded, "h");
  EXPECT_EQ(writer.tilt({1.25, 0.1}), "TILT 0.1 1.25 h 1.25\n");
  EXPECT_EQ(writer.odometry({1.0, {1e-7, 1e22, -0.5}}), "ODOM 0.0000001 10000000000000000000000 -0.5 0 0 0 1 h 1\n");
}

// The arc from pose to pose, in the frame of the robot, over the time.
TEST(CarmenWriter, SpeedsAreThoseSinceTheOdometryBefore) {
  CarmenWriter writer(CarmenWriter::kAsNeeded, "h");
  const auto line_of = [&writer](double stamp_s, const Pose2& pose) { return writer.odometry({stamp_s, pose}); };
  EXPECT_THAT(line_of(-1.0, {1.0, 0.0, 0.0}), HasSubstr(" 0 0 0 -1 h"));
  EXPECT_THAT(line_of(1.0, {4.0, 0.0, 0.0}), HasSubstr("ODOM 4 0 0 1.5 0 0 1 h"));
  EXPECT_THAT(line_of(1.5, {4.0, 0.0, -0.25}), HasSubstr("ODOM 4 0 -0.25 0 -0.5 0 1.5 h"));
  EXPECT_THAT(line_of(1.5, {9.0, 0.0, 0.5}), HasSubstr("ODOM 9 0 0.5 0 -0.5 0 1.5 h")) << "no time went by";
  EXPECT_THAT(line_of(1.0, {9.0, 0.0, 0.0}), HasSubstr("ODOM 9 0 0 0 -0.5 0 1 h")) << "back in time";
  EXPECT_THAT(line_of(2.0, {9.5, 0.0, 0.0}), HasSubstr("ODOM 9.5 0 0 0.5 0 0 2 h"));
}

TEST(CarmenWriter, AFlaserTellsItsBearingsByTheNumberOfItsBeams) {
  const double degree_rad = rad_from_deg(1.0);
  CarmenWriter writer(2, "h");
  const auto message_kind = [&writer](std::size_t beams, double first_rad, double step_rad) {
    const ScanRecord record = carmen_scan(beams, first_rad, step_rad);
    const std::string line = writer.scan(record);
    const std::string kind = line.substr(0, line.find(' '));
    EXPECT_EQ(kind == "FLASER", writer.is_told_by_beam_count(record.scan));
    return kind;
  };
  for (const auto& [beams, parts] : {std::pair(180U, 1), {181U, 1}, {360U, 2}, {361U, 2}}) {
    EXPECT_EQ(message_kind(beams, -kPi / 2, degree_rad / parts), "FLASER") << beams;
    EXPECT_EQ(message_kind(beams, -kPi / 2 + 9e-10, degree_rad / parts - 9e-10), "FLASER") << beams;
    EXPECT_EQ(message_kind(beams, -kPi / 2 - 1.1e-9, degree_rad / parts), "ROBOTLASER1") << beams;
    EXPECT_EQ(message_kind(beams, -kPi / 2, degree_rad / parts + 1.1e-9), "ROBOTLASER1") << beams;
    EXPECT_EQ(message_kind(beams, kPi / 2, degree_rad / parts), "ROBOTLASER1") << beams;
  }
  for (const std::size_t beams : {179U, 182U, 359U, 362U}) {
    const BearingRule rule = bearing_rule(beams);
    EXPECT_EQ(message_kind(beams, rule.first_rad, rule.step_rad), "ROBOTLASER1") << beams;
  }
  CarmenWriter exact(CarmenWriter::kAsNeeded);
  const BearingRule rule = bearing_rule(180);
  EXPECT_TRUE(exact.is_told_by_beam_count(carmen_scan(180, rule.first_rad, rule.step_rad).scan));
  EXPECT_FALSE(exact.is_told_by_beam_count(carmen_scan(180, std::nextafter(rule.first_rad, 0.0), rule.step_rad).scan));
}

// ROBOTLASER1 type start_angle field_of_view resolution max_range accuracy remission_mode n ranges m laser robot tv rv
// forward_safety side_safety turn_axis stamp
TEST(CarmenWriter, ARobotlaserHasItsSensor) {
  CarmenWriter writer(2, "h");
  ScanRecord record = carmen_scan(3, -0.5, 0.25);
  record.scan.max_range_m = 30.0;
  record.scan.T_base_laser = {0.5, 0.25, 0.125};
  EXPECT_EQ(writer.scan(record),
            "ROBOTLASER1 0 -0.500000000000 0.500000000000 0.250000000000 30.000000 0.010000 0 3 1.50 1.50 1.50 0"
            " 1.500000 2.250000 0.125000 1.000000 2.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000"
            " 2.000000 h 2.000000\n");
  record.laser = 1;
  EXPECT_THAT(writer.scan(record), StartsWith("ROBOTLASER2 0 "));
  record.scan.ranges_m.clear();
  EXPECT_THAT(writer.scan(record), StartsWith("ROBOTLASER2 0 -0.500000000000 0.000000000000 0.250000000000"));
}

TEST(CarmenWriter, AFlaserHasRangesAndPoses) {
  CarmenWriter writer(1, "h");
  const BearingRule rule = bearing_rule(180);
  ScanRecord record = carmen_scan(180, rule.first_rad, rule.step_rad);
  std::string ranges;
  for (int k = 0; k < 180; ++k) ranges += " 1.5";
  const std::string poses = " 1.000000 2.000000 0.000000 1.000000 2.000000 0.000000 2.000000 h 2.000000\n";
  EXPECT_EQ(writer.scan(record), "FLASER 180" + ranges + poses);
  record.laser = 1;
  EXPECT_EQ(writer.scan(record), "RLASER 180" + ranges + poses);
  // Without a mount the poses are equal, digit for digit, also where an angle is beyond a turn.
  record.T_odom_base = Pose2{1.0, 2.0, 7.0};
  EXPECT_THAT(writer.scan(record), HasSubstr(" 1.000000 2.000000 7.000000 1.000000 2.000000 7.000000 2.000000"));
}

std::vector<std::string> lines_written(const std::vector<LogRecord>& records) {
  const TemporaryFolder folder;
  AtomicFileSet files;
  const auto writer = make_log_writer(LogFormat::kCarmen, folder / "a.log", {}, files);
  for (const LogRecord& record : records) writer->write(record);
  writer->finish();
  files.commit();
  std::vector<std::string> lines;
  std::string text = get_file(folder / "a.log");
  for (std::size_t end = 0; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
    lines.push_back(text.substr(0, end));
  }
  return lines;
}

std::vector<std::string> first_words(const std::vector<std::string>& lines, std::size_t words = 1) {
  std::vector<std::string> firsts;
  for (const std::string& line : lines) {
    std::size_t end = 0;
    for (std::size_t k = 0; k < words; ++k) end = line.find(' ', end + 1);
    firsts.push_back(line.substr(0, end));
  }
  return firsts;
}

// A FLASER line has no limit of its ranges: a parameter before it tells it, where it changes.
TEST(CarmenLogs, TheLimitOfAFlaserIsAParameter) {
  const BearingRule rule = bearing_rule(180);
  ScanRecord near = carmen_scan(180, rule.first_rad, rule.step_rad);
  near.scan.max_range_m = 8.0;
  ScanRecord far = near;
  far.scan.max_range_m = 80.5;
  ScanRecord unknown = near;
  unknown.scan.max_range_m = 0.0;
  ScanRecord robotlaser = carmen_scan(3, -0.5, 0.25);
  robotlaser.scan.max_range_m = 30.0;
  EXPECT_THAT(first_words(lines_written({near, near, robotlaser, near, far})),
              ElementsAre("PARAM", "FLASER", "FLASER", "ROBOTLASER1", "FLASER", "PARAM", "FLASER"));
  EXPECT_EQ(lines_written({far}).at(0), "PARAM robot_front_laser_max 80.5 0 gdtslam 0");
  EXPECT_THAT(first_words(lines_written({unknown, near, unknown, near})),
              ElementsAre("FLASER", "PARAM", "FLASER", "FLASER", "PARAM", "FLASER"));
  // One that the log tells itself is not told again; what is no number tells nothing.
  EXPECT_THAT(first_words(lines_written({Parameter{"robot_front_laser_max", "8"}, near})),
              ElementsAre("PARAM", "FLASER"));
  EXPECT_THAT(first_words(lines_written({Parameter{"robot_front_laser_max", "8m"}, near})),
              ElementsAre("PARAM", "PARAM", "FLASER"));
  EXPECT_THAT(first_words(lines_written({Parameter{"robot_laser_max", "8"}, near})),
              ElementsAre("PARAM", "PARAM", "FLASER"));
}

// Of two lasers, one of unknown limit, none gets that of the other.
TEST(CarmenLogs, ALimitIsThatOfItsOwnLaser) {
  const BearingRule rule = bearing_rule(180);
  const auto scan_of = [&rule](std::size_t laser, double limit_m) {
    ScanRecord record = carmen_scan(180, rule.first_rad, rule.step_rad);
    record.laser = laser;
    record.scan.max_range_m = limit_m;
    return record;
  };
  for (const std::size_t known : {0U, 1U}) {
    const std::string known_line = known == 0 ? "FLASER" : "RLASER";
    const std::string unknown_line = known == 0 ? "RLASER" : "FLASER";
    const ScanRecord near = scan_of(known, 8.0);
    const ScanRecord unknown = scan_of(1 - known, 0.0);
    EXPECT_THAT(first_words(lines_written({near, unknown, near})), ElementsAre("PARAM", known_line, known_line));
    EXPECT_THAT(first_words(lines_written({unknown, near, unknown})),
                ElementsAre(unknown_line, known_line, unknown_line));
    EXPECT_THAT(first_words(lines_written({near, scan_of(1 - known, 9.0)})),
                ElementsAre("PARAM", known_line, "PARAM", unknown_line));
  }
  ScanRecord robotlaser = carmen_scan(3, -0.5, 0.25);
  robotlaser.laser = 1;  // whose line says that its limit is not known, which readers take from the parameter
  EXPECT_THAT(first_words(lines_written({scan_of(0, 8.0), robotlaser})), ElementsAre("PARAM", "FLASER"));
  // Also after a scan of the first laser whose limit is not known, which gets the one before.
  EXPECT_THAT(first_words(lines_written({scan_of(0, 8.0), scan_of(0, 0.0), scan_of(1, 0.0), scan_of(0, 8.0)})),
              ElementsAre("PARAM", "FLASER", "FLASER", "PARAM", "FLASER"));
  // Nor does a scan get the limit of a laser which no longer knows it.
  EXPECT_THAT(first_words(lines_written({scan_of(0, 8.0), scan_of(0, 0.0), scan_of(1, 30.0)})),
              ElementsAre("PARAM", "FLASER", "FLASER"));
  // One that knows it gets its own, also where the log has told another before.
  const Parameter front{"robot_front_laser_max", "8"};
  EXPECT_THAT(first_words(lines_written({scan_of(1, 0.0), front, scan_of(0, 30.0), scan_of(1, 0.0)})),
              ElementsAre("RLASER", "PARAM", "PARAM", "FLASER"));
  // A parameter that is no range is left out by readers, who keep the one before.
  const Parameter none{"robot_front_laser_max", "far"};
  EXPECT_THAT(first_words(lines_written({scan_of(0, 8.0), none, scan_of(0, 8.0), scan_of(1, 0.0)})),
              ElementsAre("PARAM", "FLASER", "PARAM", "FLASER"));
}

TEST(CarmenLogs, StepsAreAboveZero) {
  const auto sensor_of = [](std::size_t beams, double step_rad) {
    return first_words(lines_written({carmen_scan(beams, 0.5, step_rad)}), 5).at(0);
  };
  // A laser of one beam has no step: one degree stands for it.
  EXPECT_EQ(sensor_of(1, 0.0), "ROBOTLASER1 0 0.5 0 0.017453292519943295");
  EXPECT_EQ(sensor_of(1, 0.25), "ROBOTLASER1 0 0.5 0 0.25");
  EXPECT_EQ(sensor_of(2, -0.25), "ROBOTLASER1 0 0.25 0.25 0.25");
  EXPECT_EQ(sensor_of(3, -0.25), "ROBOTLASER1 0 0 0.5 0.25");
}

}  // namespace
}  // namespace gdtslam

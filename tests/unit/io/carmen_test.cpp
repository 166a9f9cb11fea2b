// The CARMEN reader on lines whose meaning is written in the format's description.
#include "engine/io/logs/carmen.hpp"
#include "gdtslam/io/log.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::HasSubstr;

constexpr double kDeg = kPi / 180.0;

std::string flaser(std::size_t beams, const std::string& range = "2.5") {
  std::string line = "FLASER " + std::to_string(beams);
  for (std::size_t k = 0; k < beams; ++k) {
    line += " " + range;
  }
  return line + " 1 2 0.5 1 2 0.5 100.25 host 0.5\n";
}

TEST(Carmen, ReadsFlaser) {
  const WholeLog log = read_text("FLASER 3 1.07 2.50 81.83 1.0 2.0 0.5 1.0 2.0 0.5 976052857.337284 nohost 0.1\n");
  ASSERT_EQ(log.records.size(), 1U);
  const auto& record = std::get<ScanRecord>(log.records[0]);
  EXPECT_THAT(record.scan.ranges_m, ::testing::ElementsAre(1.07F, 2.50F, 81.83F));
  EXPECT_EQ(record.scan.stamp_s, 976052857.337284);
  EXPECT_EQ(record.T_odom_base, (Pose2{1.0, 2.0, 0.5}));
  EXPECT_EQ(record.scan.T_base_laser, Pose2{});
  EXPECT_EQ(record.scan.max_range_m, 0.0);
  EXPECT_TRUE(log.warnings.empty());
}

TEST(Carmen, MountIsTheLaserSeenFromTheRobot) {
  // The robot looks along +y; the laser sits 4 cm behind it and 1 cm to its left, turned by 0.1 rad.
  const WholeLog log = read_text("FLASER 1 1.0 4.99 4.96 1.6707963267948966 5 5 1.5707963267948966 1 h 1\n");
  const Pose2 T_base_laser = std::get<ScanRecord>(log.records.at(0)).scan.T_base_laser;
  EXPECT_NEAR(T_base_laser.x_m, -0.04, 1e-12);
  EXPECT_NEAR(T_base_laser.y_m, 0.01, 1e-12);
  EXPECT_NEAR(T_base_laser.theta_rad, 0.1, 1e-12);
}

/// The mounts of FLASER lines whose poses have so many decimals; the laser sits at T_base_laser, the robot wanders.
std::vector<Pose2> mounts_read(const Pose2& T_base_laser, int decimals) {
  std::string text;
  for (int k = 0; k < 200; ++k) {
    const Pose2 T_odom_base{0.37 * k - 20.0, 577.27 - 0.11 * k, std::remainder(0.1 * k, kTwoPi)};
    const Pose2 T_odom_laser = T_odom_base * T_base_laser;
    text += "FLASER 1 1.0";
    for (const Pose2& pose : {T_odom_laser, T_odom_base}) {
      text += fmt::format(" {:.{}f} {:.{}f} {:.{}f}", pose.x_m, decimals, pose.y_m, decimals, pose.theta_rad, decimals);
    }
    text += fmt::format(" {} h {}\n", k, k);
  }
  std::vector<Pose2> mounts;
  const WholeLog log = read_text(text);
  for (const ScanRecord& record : log.of<ScanRecord>()) mounts.push_back(record.scan.T_base_laser);
  return mounts;
}

TEST(Carmen, TheMountOfALogIsOneNumberThoughItsPosesAreRounded) {
  for (const Pose2& T_base_laser :
       {Pose2{0.1, 0.0, 0.0}, Pose2{-0.04, 0.123, 3.14159}, Pose2{0.29173, -0.00001, -1.2}}) {
    for (const int decimals : {6, 9, 15}) {
      const std::vector<Pose2> mounts = mounts_read(T_base_laser, decimals);
      ASSERT_EQ(mounts.size(), 200U);
      for (const Pose2& mount : mounts) ASSERT_EQ(mount, T_base_laser) << decimals;
    }
  }
}

TEST(Carmen, AMountThatMovesIsFollowed) {
  const WholeLog log = read_text(
      "FLASER 1 1.0 0.100000 0 0 0 0 0 1 h 1\n"
      "FLASER 1 1.0 0.100009 0 0 0 0 0 2 h 2\n"
      "FLASER 1 1.0 0.200000 0 0 0 0 0 3 h 3\n"
      "FLASER 1 1.0 1e-1 0 0 0 0 0 4 h 4\n");
  const auto scans = log.of<ScanRecord>();
  ASSERT_EQ(scans.size(), 4U);
  for (const auto& [index, x_m] : {std::pair(0, 0.1), std::pair(1, 0.1), std::pair(2, 0.2), std::pair(3, 0.1)}) {
    EXPECT_EQ(scans[static_cast<std::size_t>(index)].scan.T_base_laser.x_m, x_m);
  }
}

TEST(Carmen, ReadsRobotlaser) {
  const WholeLog log = read_text(
      "ROBOTLASER1 0 -1.5 3.0 0.0174 80.0 0.01 1 2 3.5 4.5 2 10 20 1.1 2.0 0.0 1.0 2.0 0.0 0.4 0.1 0.5 0.3 1e6 "
      "1234.5 host 0.5\n");
  const auto& record = std::get<ScanRecord>(log.records.at(0));
  EXPECT_THAT(record.scan.ranges_m, ::testing::ElementsAre(3.5F, 4.5F));
  EXPECT_EQ(record.scan.first_bearing_rad, -1.5);
  EXPECT_EQ(record.scan.bearing_step_rad, 0.0174);
  EXPECT_EQ(record.scan.max_range_m, 80.0);
  EXPECT_EQ(record.scan.stamp_s, 1234.5);
  EXPECT_NEAR(record.scan.T_base_laser.x_m, 0.1, 1e-12);
  EXPECT_EQ(record.T_odom_base, (Pose2{1.0, 2.0, 0.0}));
}

TEST(Carmen, ReadsTheOtherKinds) {
  const WholeLog log = read_text(
      "# comment\n\n"
      "PARAM robot_frontlaser_offset 0.07 nohost 0\n"
      "ODOM 1.5 -2.5 0.25 0.4 0.1 0 10.5 nohost 0.1\n"
      "ENCODER -123456789012 11.5 nohost 0.2\n"
      "TILT -0.75 12.5 nohost 0.3\n");
  ASSERT_EQ(log.records.size(), 4U);
  const auto& parameter = std::get<Parameter>(log.records[0]);
  EXPECT_EQ(parameter.name, "robot_frontlaser_offset");
  EXPECT_EQ(parameter.value, "0.07");
  const auto& odometry = std::get<Odometry>(log.records[1]);
  EXPECT_EQ(odometry.T_odom_base, (Pose2{1.5, -2.5, 0.25}));
  EXPECT_EQ(odometry.stamp_s, 10.5);
  EXPECT_EQ(std::get<Encoder>(log.records[2]).ticks, -123456789012);
  EXPECT_EQ(std::get<Encoder>(log.records[2]).stamp_s, 11.5);
  EXPECT_EQ(std::get<Tilt>(log.records[3]).elevation_rad, -0.75);
  EXPECT_EQ(std::get<Tilt>(log.records[3]).stamp_s, 12.5);
}

TEST(Carmen, SkipsOtherMessagesAndCountsThemByKind) {
  const WholeLog log = read_text("SYNC a\nRLASER 1 2 3\nSYNC b\n" + flaser(1) + "TRUEPOS 1 2 3\n");
  EXPECT_EQ(log.records.size(), 1U);
  EXPECT_EQ(log.warned("skipped message SYNC"), 2U);
  EXPECT_EQ(log.warned("skipped message RLASER"), 1U);
  EXPECT_EQ(log.warned("skipped message TRUEPOS"), 1U);
  EXPECT_THAT(log.warnings.at(0).first, HasSubstr("test.log:1:"));
}

TEST(Carmen, ReadsWindowsLineEndsTabsAndAByteOrderMark) {
  const WholeLog log =
      read_text("\xef\xbb\xbf# made on Windows\r\nFLASER\t1  2.5 1 2 0 1 2 0 7 h 0\r\nPARAM a b c d\r\n");
  ASSERT_EQ(log.records.size(), 2U);
  EXPECT_EQ(std::get<ScanRecord>(log.records[0]).scan.stamp_s, 7.0);
  EXPECT_EQ(std::get<Parameter>(log.records[1]).value, "b");
}

TEST(Carmen, BearingsFollowTheNumberOfBeams) {
  struct Case {
    std::size_t beams;
    double first_deg;
    double step_deg;
    double last_deg;
  };
  for (const Case& c :
       {Case{180, -90, 1.0, 89}, Case{360, -90, 0.5, 89.5}, Case{361, -90, 0.5, 90}, Case{181, -90, 1.0, 90},
        Case{90, -90, 2.0, 88}, Case{401, -50, 0.25, 50}, Case{101, -50, 1.0, 50}, Case{201, -50, 0.5, 50}}) {
    const LaserScan scan = std::get<ScanRecord>(read_text(flaser(c.beams)).records.at(0)).scan;
    EXPECT_NEAR(scan.first_bearing_rad, c.first_deg * kDeg, 1e-12) << c.beams;
    EXPECT_NEAR(scan.bearing_step_rad, c.step_deg * kDeg, 1e-12) << c.beams;
    const double last = scan.first_bearing_rad + static_cast<double>(c.beams - 1) * scan.bearing_step_rad;
    EXPECT_NEAR(last, c.last_deg * kDeg, 1e-12) << c.beams;
  }
  EXPECT_EQ(bearing_rule(1).first_rad, 0.0);
}

TEST(Carmen, OptionsOverrideWhatTheLogSays) {
  ReadOptions options;
  options.first_bearing_rad = -2.0;
  options.bearing_step_rad = 0.01;
  options.max_range_m = 30.0;
  options.T_base_laser = Pose2{0.2, 0.0, 3.0};
  const LaserScan scan = std::get<ScanRecord>(read_text(flaser(180), options).records.at(0)).scan;
  EXPECT_EQ(scan.first_bearing_rad, -2.0);
  EXPECT_EQ(scan.bearing_step_rad, 0.01);
  EXPECT_EQ(scan.max_range_m, 30.0);
  EXPECT_EQ(scan.T_base_laser, (Pose2{0.2, 0.0, 3.0}));
}

TEST(Carmen, SensorLimitComesFromTheParameter) {
  const WholeLog log = read_text(flaser(2) + "PARAM robot_front_laser_max 80.99 1 h 1\n" + flaser(2));
  const auto scans = log.of<ScanRecord>();
  EXPECT_EQ(scans.at(0).scan.max_range_m, 0.0);
  EXPECT_EQ(scans.at(1).scan.max_range_m, 80.99);
}

TEST(Carmen, LivePipeGivesEachLineWhenItCame) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const auto send = [&](const std::string& text) {
    EXPECT_EQ(::write(ends[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  };
  send("TILT 0.5 1 h 2\n");
  const auto reader = open_log("/dev/fd/" + std::to_string(ends[0]), {});
  EXPECT_TRUE(reader->next().has_value());  // would wait for ever if it wanted more than this line
  send("TILT 0.6 2 h 2\nTILT 0.7 3 h 2\n");
  EXPECT_TRUE(reader->next().has_value());
  EXPECT_TRUE(reader->next().has_value());
  EXPECT_LT(reader->progress(), 0.0);
  ::close(ends[1]);
  EXPECT_FALSE(reader->next().has_value());
  ::close(ends[0]);
}

// The sample log, counted with zcat and awk: 350 FLASER of 180 beams, 584 ODOM; PARAM robot_frontlaser_offset is 0.1.
const std::string kSample = GDTSLAM_SOURCE_DIR "/assets/logs/office-start.log.gz";

TEST(CarmenSample, HasItsKnownCounts) {
  const WholeLog log = drain(*open_log(kSample, {}));
  const auto scans = log.of<ScanRecord>();
  EXPECT_EQ(scans.size(), 350U);
  EXPECT_EQ(log.of<Odometry>().size(), 584U);
  EXPECT_TRUE(log.warnings.empty());
  for (const ScanRecord& record : scans) {
    ASSERT_EQ(record.scan.ranges_m.size(), 180U);
    ASSERT_EQ(record.scan.T_base_laser, (Pose2{0.1, 0.0, 0.0}));  // the scene's
    ASSERT_TRUE(record.T_odom_base.has_value());
  }
  EXPECT_EQ(scans.back().scan.max_range_m, 80.0);
}

TEST(CarmenRealData, IntelHasItsKnownCounts) {
  GDTSLAM_REAL_DATA(path, "slam2d/intel.clf.gz");
  const auto reader = open_log(path, {});
  const WholeLog log = drain(*reader);
  const auto scans = log.of<ScanRecord>();
  EXPECT_EQ(scans.size(), 13631U);
  EXPECT_EQ(log.of<Odometry>().size(), 26915U);
  EXPECT_EQ(log.warned("backward stamp"), 631U);
  EXPECT_EQ(log.warnings.size(), 1U);
  for (const ScanRecord& record : scans) {
    ASSERT_EQ(record.scan.ranges_m.size(), 180U);
    ASSERT_EQ(record.scan.T_base_laser, Pose2{});
  }
}

TEST(Carmen, CountsEmptyLines) {
  // More than any buffer holds, before the first line and between others; an empty line is one with blanks, too.
  const std::string many(300'001, '\n');
  const auto error = [](const std::string& text) {
    try {
      static_cast<void>(read_text(text));
      return std::string("none");
    } catch (const InputError& wrong) {
      return std::string(wrong.what());
    }
  };
  EXPECT_THAT(error(many + "FLASER x\n"), HasSubstr(":300002: "));
  EXPECT_THAT(error(flaser(3) + many + " \r\n" + many + "FLASER x\n"), HasSubstr(":600005: "));
  EXPECT_THAT(error(many), HasSubstr(" in 300001 lines"));
  EXPECT_EQ(read_text(many + flaser(3) + many + flaser(4) + many).of<ScanRecord>().size(), 2U);
}

}  // namespace
}  // namespace gdtslam

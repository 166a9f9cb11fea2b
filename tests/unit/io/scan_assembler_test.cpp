// Scans with the odometry of their stamps out of messages that come in any order, at the limits of what is waited for
// and of what is taken for a sweep, a mount and a clock.
#include "engine/io/recordings/scan_assembler.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// An assembler and how often it warned of what.
struct Assembly {
  explicit Assembly(const ReadOptions& options = {})
      : assembler(options, [this](std::string_view kind, const std::string&) { ++warned[std::string(kind)]; }) {}
  Assembly(const Assembly&) = delete;
  Assembly& operator=(const Assembly&) = delete;
  ~Assembly() = default;
  void scan(ScanMessage message, std::size_t laser = 0) {
    const double stamp_s = message.stamp_s;
    assembler.add_scan(laser, std::move(message), stamp_s);
  }
  void pose(double stamp_s, const Pose2& pose, double late_s = 0.0) {
    const double c = std::cos(pose.theta_rad);
    const double s = std::sin(pose.theta_rad);
    Transform3 T{.rotation = {c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0}, .shift_m = {pose.x_m, pose.y_m, 0.0}};
    assembler.add_odometry({.stamp_s = stamp_s, .parent = "odom", .child = "base_link", .T_parent_child = T},
                           stamp_s + late_s);
  }
  std::optional<ScanRecord> next(bool at_end = false) {
    const std::optional<LogRecord> record = assembler.next(at_end);
    return record ? std::optional(std::get<ScanRecord>(*record)) : std::nullopt;
  }
  std::map<std::string, int> warned;
  ScanAssembler assembler;
};

ScanMessage scan_at(double stamp_s, std::vector<float> ranges_m = {1.0F, 2.0F, 3.0F}) {
  return {.stamp_s = stamp_s,
          .frame = "base_link",
          .first_bearing_rad = -0.5,
          .bearing_step_rad = 0.25,
          .min_range_m = 0.1,
          .max_range_m = 30.0,
          .ranges_m = std::move(ranges_m)};
}

// A quarter of a circle of radius 1 from (0, 0) to (1, 1): by thirds of the time it is thirds of the way around.
TEST(ScanAssembler, OdometryBetweenTwoPosesLiesOnTheCircleThroughThem) {
  Assembly assembly;
  assembly.assembler.add_laser("/scan");
  assembly.pose(1.0, {0.0, 0.0, 0.0});
  assembly.pose(4.0, {1.0, 1.0, 0.5 * kPi});
  for (const double stamp_s : {1.0, 2.0, 3.0, 4.0}) assembly.scan(scan_at(stamp_s));
  for (int third = 0; third <= 3; ++third) {
    const Pose2 pose = assembly.next().value().T_odom_base.value();
    const double angle = third * kPi / 6.0;
    EXPECT_NEAR(pose.x_m, std::sin(angle), 1e-12) << third;
    EXPECT_NEAR(pose.y_m, 1.0 - std::cos(angle), 1e-12) << third;
    EXPECT_NEAR(pose.theta_rad, angle, 1e-12) << third;
  }
}

TEST(ScanAssembler, BeforeTheFirstPoseThereIsNoneAndBehindTheLastItIsThat) {
  Assembly assembly;
  assembly.assembler.add_laser("/scan");
  assembly.scan(scan_at(0.5));
  assembly.scan(scan_at(2.0));
  assembly.scan(scan_at(2.5));
  EXPECT_FALSE(assembly.next()) << "no odometry yet";
  assembly.pose(1.0, {1.0, 0.0, 0.0});
  EXPECT_FALSE(assembly.next()->T_odom_base);
  EXPECT_FALSE(assembly.next()) << "a pose behind the scan is needed";
  assembly.pose(2.0, {3.0, 0.0, 0.0});
  EXPECT_EQ(assembly.next()->T_odom_base->x_m, 3.0) << "one of its own stamp is enough";
  EXPECT_FALSE(assembly.next());
  EXPECT_EQ(assembly.next(true)->T_odom_base->x_m, 3.0);
  EXPECT_EQ(assembly.warned["scan after the last odometry"], 1);
}

TEST(ScanAssembler, OdometryThatStepsBackIsLeftOutAndOneThatRepeatsIsNotTold) {
  Assembly assembly;
  assembly.assembler.add_laser("/scan");
  assembly.pose(1.0, {1.0, 0.0, 0.0});
  assembly.pose(2.0, {2.0, 0.0, 0.0});
  assembly.pose(2.0, {9.0, 0.0, 0.0});
  EXPECT_THAT(assembly.warned, IsEmpty());
  assembly.pose(1.5, {9.0, 0.0, 0.0});
  EXPECT_EQ(assembly.warned["odometry steps back in time"], 1);
  assembly.scan(scan_at(1.5));
  assembly.scan(scan_at(2.0));
  EXPECT_EQ(assembly.next()->T_odom_base->x_m, 1.5);
  EXPECT_EQ(assembly.next()->T_odom_base->x_m, 2.0);
}

/// x = t, four poses and a scan in 0.2 s from 100 s on; x less t of each scan that comes out with odometry.
std::vector<double> off_m(Assembly& assembly, const std::function<double(double)>& scan_clock,
                          const std::function<double(double)>& pose_clock) {
  assembly.assembler.add_laser("/scan");
  std::vector<double> off;
  const auto give = [&](bool at_end) {
    while (const std::optional<ScanRecord> record = assembly.next(at_end)) {
      const double true_s = 100.0 + 0.2 * static_cast<double>(off.size());
      off.push_back(record->T_odom_base ? record->T_odom_base->x_m - true_s : 1e9);
    }
  };
  for (int k = 0; k < 100; ++k) {
    const double t = 100.0 + 0.2 * k;
    for (int part = 0; part < 4; ++part) {
      const double part_s = t + 0.05 * part;
      // Recorders repeat themselves: the second of a stamp says nothing.
      for (int twice = 0; twice < 2; ++twice) assembly.pose(pose_clock(part_s), {part_s, 0.0, 0.0});
    }
    assembly.scan(scan_at(scan_clock(t)));
    give(false);
  }
  give(true);
  return off;
}

TEST(ScanAssembler, WhenTheClockIsSetBackScansGetThePosesOfTheirSide) {
  for (const double back_s : {5.0, 900.0}) {
    Assembly assembly;
    const auto clock = [&](double t) { return t < 109.99 ? t : t - back_s; };
    const std::vector<double> off = off_m(assembly, clock, clock);
    ASSERT_EQ(off.size(), 100U);
    for (std::size_t k = 0; k < off.size(); ++k) EXPECT_NEAR(off[k], 0.0, 1e-6) << back_s << ' ' << k;
    EXPECT_EQ(assembly.warned["odometry's clock was set back"], 1);
  }
}

TEST(ScanAssembler, OnePoseFarAheadIsLeftOut) {
  Assembly assembly;
  const auto pose_clock = [](double t) { return std::fabs(t - 110.05) < 1e-6 ? t + 3600.0 : t; };
  const std::vector<double> off = off_m(
      assembly, [](double t) { return t; }, pose_clock);
  ASSERT_EQ(off.size(), 100U);
  for (std::size_t k = 0; k < off.size(); ++k) EXPECT_NEAR(off[k], 0.0, 1e-6) << k;
  EXPECT_EQ(assembly.warned["odometry far ahead in time"], 1);
  EXPECT_EQ(assembly.warned["odometry steps back in time"], 4) << "until the fifth told";
}

// scan_assembler.hpp: kMostHeldScans scans wait for odometry, kMostPoses poses are kept.
TEST(ScanAssembler, SixtyFourScansWaitForOdometry) {
  Assembly assembly;
  assembly.assembler.add_laser("/scan");
  for (int k = 1; k <= 64; ++k) {
    assembly.scan(scan_at(0.1 * k));
    ASSERT_FALSE(assembly.next()) << k;
  }
  assembly.scan(scan_at(6.5));
  const std::optional<ScanRecord> first = assembly.next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->scan.stamp_s, 0.1);
  EXPECT_FALSE(first->T_odom_base);
  EXPECT_FALSE(assembly.next()) << "64 again";
}

TEST(ScanAssembler, TheLast4096PosesAreKept) {
  for (const int poses : {4096, 4097}) {
    Assembly assembly;
    assembly.assembler.add_laser("/scan");
    for (int k = 0; k < poses; ++k) assembly.pose(1.0 + k, {1.0 * k, 0.0, 0.0});
    assembly.scan(scan_at(1.0));
    EXPECT_EQ(assembly.next()->T_odom_base.has_value(), poses == 4096) << poses;
  }
}

void add_mount(Assembly& assembly, const std::string& frame, double roll_rad) {
  const double c = std::cos(roll_rad);
  const double s = std::sin(roll_rad);
  assembly.assembler.add_transform(
      {.stamp_s = 1.0,
       .parent = "base_link",
       .child = frame,
       .T_parent_child = {.rotation = {1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c}, .shift_m = {0.25, 0.125, 1.0}}},
      1.0);
}

// Up to 3 degrees a laser counts as level; so does one upside down.
TEST(ScanAssembler, ALaserTiltedByMoreThan3DegreesIsTold) {
  for (const auto& [roll_deg, is_told] :
       {std::pair(0.0, 0), {2.9, 0}, {-2.9, 0}, {3.1, 1}, {-11.5, 1}, {90.0, 1}, {176.9, 1}, {177.1, 0}, {180.0, 0}}) {
    Assembly assembly;
    assembly.assembler.add_laser("/scan");
    add_mount(assembly, "laser", rad_from_deg(roll_deg));
    assembly.pose(1.0, {});
    ScanMessage scan = scan_at(1.0);
    scan.frame = "laser";
    assembly.scan(scan);
    const std::optional<ScanRecord> record = assembly.next();
    ASSERT_TRUE(record) << "its mount is known";
    EXPECT_EQ(record->scan.T_base_laser.x_m, 0.25);
    EXPECT_EQ(record->scan.T_base_laser.y_m, 0.125);
    EXPECT_EQ(assembly.warned["laser is not level"], is_told) << roll_deg;
    EXPECT_EQ(assembly.warned["laser mount unknown"], 0);
    EXPECT_EQ(assembly.assembler.laser_contents(0).mount, MountSource::kFrames);
    EXPECT_THAT(assembly.assembler.laser_contents(0).chain, ElementsAre("laser", "base_link"));
  }
}

// As of robots whose odometry ends at a footprint that nobody ties to the base on which the laser is.
TEST(ScanAssembler, AMountOnWhatIsCalledLikeABaseCountsWhereOdometryIsOfAnother) {
  Assembly assembly;
  assembly.assembler.add_laser("/scan");
  add_mount(assembly, "laser", 0.0);
  assembly.assembler.add_odometry({.stamp_s = 1.0, .parent = "odom", .child = "base_footprint", .T_parent_child = {}},
                                  1.0);
  ScanMessage scan = scan_at(1.0);
  scan.frame = "laser";
  assembly.scan(scan);
  EXPECT_FALSE(assembly.next()) << "the way to base_footprint may still come";
  EXPECT_EQ(assembly.next(true).value().scan.T_base_laser.x_m, 0.25);
  EXPECT_EQ(assembly.warned["laser mount unknown"], 0);
  const LaserContents contents = assembly.assembler.laser_contents(0);
  EXPECT_EQ(contents.mount, MountSource::kFrames);
  EXPECT_THAT(contents.chain, ElementsAre("laser", "base_link"));
}

}  // namespace
}  // namespace gdtslam

// Motion by scans beside motion by wheels: agreements of motions made by hand, and faults put into a drive.
#include "engine/runs/streams/scan_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "drive_log.hpp"
#include "engine/runs/log_look.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

using test::DriveLog;
using testing::HasSubstr;
using testing::IsEmpty;

Pose2 pose_at(double t) {
  const double heading = 1.1 * std::sin(0.7 * t) + 0.6 * std::sin(0.31 * t);
  return {0.5 * t, 0.3 * std::sin(0.2 * t), heading};
}

/// 5 scans a second for 80 s; odometry is late, and the scans turn so many times as far.
std::vector<TimedMotion> turning(double times, double delay_s, double noise_rad) {
  Random random(7);
  std::vector<TimedMotion> motions;
  for (int k = 0; k < 400; ++k) {
    const double t = 0.2 * k;
    Pose2 by_scans = pose_at(t);
    by_scans.theta_rad = wrap_angle(times * by_scans.theta_rad + noise_rad * random.normal());
    motions.push_back({1000.0 + t, pose_at(t - delay_s), by_scans});
  }
  return motions;
}

TEST(ScanMotion, OppositeTurnsAreCertainAlsoWithADelayAndNoise) {
  for (const double delay_s : {0.0, 0.2, -0.2}) {
    EXPECT_TRUE(turn_agreement(turning(-1.0, delay_s, 0.02)).is_opposite()) << delay_s;
    EXPECT_FALSE(turn_agreement(turning(1.0, delay_s, 0.02)).is_opposite()) << delay_s;
  }
  EXPECT_NEAR(turn_agreement(turning(-1.0, 0.0, 0.0)).slope, -1.0, 1e-9);
  EXPECT_NEAR(turn_agreement(turning(-1.0, 0.0, 0.0)).correlation, -1.0, 1e-9);
}

TEST(ScanMotion, ScansThatTellNothingOfTurnsAreNotOpposite) {
  EXPECT_FALSE(turn_agreement(turning(0.0, 0.0, 0.5)).is_opposite());
  EXPECT_FALSE(turn_agreement(turning(-0.1, 0.0, 0.0)).is_opposite());
  EXPECT_FALSE(turn_agreement({}).is_opposite());
  std::vector<TimedMotion> few = turning(-1.0, 0.0, 0.0);
  few.resize(15);
  EXPECT_FALSE(turn_agreement(few).is_opposite());
}

/// Straight stretches with turns between; the laser's mount is turned to the left of what is assumed.
std::vector<TimedMotion> driving(double mount_off_rad, double stretch = 1.0) {
  std::vector<TimedMotion> motions;
  Pose2 pose;
  for (int k = 0; k < 200; ++k) {
    const Pose2 step = k % 20 < 15 ? Pose2{0.1, 0.0, 0.0} : Pose2{0.0, 0.0, 0.25};
    pose = pose * step;
    const Pose2 turned{0.0, 0.0, mount_off_rad};
    Pose2 by_scans = inverse(turned) * pose * turned;
    by_scans.x_m *= stretch;
    by_scans.y_m *= stretch;
    motions.push_back({0.2 * k, pose, by_scans});
  }
  return motions;
}

TEST(ScanMotion, ATurnedMountShowsByItsAngle) {
  for (const double off_deg : {180.0, 90.0, -90.0, 40.0, -135.0}) {
    const DirectionAgreement found = direction_agreement(driving(rad_from_deg(off_deg)));
    EXPECT_TRUE(found.is_turned()) << off_deg;
    EXPECT_NEAR(wrap_angle(found.left_rad + rad_from_deg(off_deg)), 0.0, 1e-9) << off_deg;
    EXPECT_NEAR(found.concentration, 1.0, 1e-9);
  }
  EXPECT_FALSE(direction_agreement(driving(0.0)).is_turned());
  EXPECT_FALSE(direction_agreement(driving(rad_from_deg(10.0))).is_turned());
}

TEST(ScanMotion, ScansThatStandOrLeapTellNoDirection) {
  EXPECT_FALSE(direction_agreement(driving(kPi, 0.5)).is_turned());
  EXPECT_FALSE(direction_agreement(driving(kPi, 2.0)).is_turned());
  EXPECT_FALSE(direction_agreement({}).is_turned());
}

std::vector<LogFinding> faults_in(const std::string& path, const ReadOptions& read = {}) {
  return motion_findings(motion_by_scans(path, read, {}, {}, [] { return false; }));
}

void leave(LaserScan& /*scan*/) {}

void turn_upside_down(LaserScan& scan) { std::reverse(scan.ranges_m.begin() + 1, scan.ranges_m.end()); }

TEST(ScanMotion, ARightDriveHasNoFaults) {
  const DriveLog log;
  EXPECT_THAT(faults_in(log.write(leave)), IsEmpty());
  EXPECT_THAT(log.map(log.write(leave)).findings, IsEmpty());
}

TEST(ScanMotion, AMirroredLaserIsNamedWithTheBearingsThatMendIt) {
  const DriveLog log;
  const std::string path = log.write([](LaserScan& scan) {
    scan.first_bearing_rad = -kPi;  // of a drive whose laser looks backward at beam 0
    std::rotate(scan.ranges_m.begin(), scan.ranges_m.begin() + 135, scan.ranges_m.end());
    turn_upside_down(scan);
  });
  const std::vector<LogFinding> faults = faults_in(path);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_THAT(faults[0].what, HasSubstr("turn opposite ways: laser upside down or mirrored, or wheels swapped"));
  EXPECT_EQ(faults[0].options, "--set log.bearings=stated --set log.bearing_step=-2deg --set log.first_bearing=180deg");
  EXPECT_FALSE(faults[0].is_mended);
  EXPECT_THAT(faults_in(path, {.first_bearing_rad = kPi, .bearing_step_rad = rad_from_deg(-2.0)}), IsEmpty());
}

TEST(ScanMotion, ATurnedMountIsNamedWithTheAngleThatMendsIt) {
  const DriveLog log;
  const auto say_ahead = [](LaserScan& scan) { scan.T_base_laser = {0.1, 0.05, 0.0}; };
  for (const double off_deg : {180.0, 90.0, -90.0}) {
    const Pose2 mount{0.1, 0.05, rad_from_deg(off_deg)};
    const std::string path = log.write(say_ahead, {}, mount);
    const std::vector<LogFinding> faults = faults_in(path);
    ASSERT_EQ(faults.size(), 1U) << off_deg;
    EXPECT_THAT(faults[0].what, HasSubstr("its mount is turned by"));
    EXPECT_THAT(faults[0].options, HasSubstr("--set log.mount_x=0.1m --set log.mount_y=0.05m --set log.mount_angle="));
    EXPECT_THAT(faults[0].options, HasSubstr(off_deg == 180.0 ? "180deg" : off_deg == 90.0 ? "=90deg" : "=-90deg"));
    EXPECT_THAT(faults_in(path, {.T_base_laser = mount}), IsEmpty());
  }
}

TEST(ScanMotion, ALiveLogIsLookedAtAfterwardsIfOneScanInTenIsDoubtful) {
  const DriveLog log;
  const std::string path = log.write(turn_upside_down);
  MapRequest request;
  request.logs = {path};
  request.live_log = [&path](const ReadOptions& read) { return open_log(path, read); };
  MapOutcome outcome;
  outcome.trajectory.resize(20);
  outcome.doubtful.resize(1);
  look_afterwards(request, path, outcome);
  EXPECT_THAT(outcome.findings, IsEmpty());
  outcome.doubtful.resize(2);
  look_afterwards(request, path, outcome);
  EXPECT_EQ(outcome.findings.size(), 1U);
}

}  // namespace
}  // namespace gdtslam

#include "engine/runs/motion/scan_speed.hpp"

#include <gtest/gtest.h>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

ScanRecord timed_scan(double stamp_s, const std::optional<Pose2>& T_odom_base, std::size_t laser = 0) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.scan.beam_period_s = 1e-4;
  record.T_odom_base = T_odom_base;
  record.laser = laser;
  return record;
}

TEST(ScanSpeed, AQuarterOfACircleInHalfASecond) {
  // Radius 1 m to the left: an arc of pi/2 m and a turn of pi/2, in half a second.
  const auto speed = speed_between({10.0, {}}, {10.5, {1.0, 1.0, kPi / 2}});
  ASSERT_TRUE(speed);
  EXPECT_LT((*speed - Eigen::Vector3d(kPi, 0.0, kPi)).norm(), 1e-9);
}

TEST(ScanSpeed, NoRobotMovesLikeThat) {
  EXPECT_FALSE(speed_between({10.0, {}}, {10.0, {0.1, 0.0, 0.0}}));
  EXPECT_FALSE(speed_between({10.0, {}}, {9.9, {0.1, 0.0, 0.0}}));
  EXPECT_FALSE(speed_between({10.0, {}}, {11.5, {0.1, 0.0, 0.0}}));  // too long ago
  EXPECT_FALSE(speed_between({10.0, {}}, {10.1, {3.1, 0.0, 0.0}}));  // 31 m/s
  EXPECT_FALSE(speed_between({10.0, {}}, {10.1, {0.0, 0.0, 1.3}}));  // 13 rad/s
  EXPECT_FALSE(speed_between({10.0, {}}, {10.1, {0.0, std::nan(""), 0.0}}));
}

TEST(ScanSpeed, ByOdometryOfTheSameLaser) {
  OdometrySpeed odometry;
  ScanRecord front = timed_scan(1.0, Pose2{}, 0);
  ScanRecord rear = timed_scan(1.001, Pose2{0.01, 0.0, 0.0}, 1);
  odometry.complete(front);
  odometry.complete(rear);
  EXPECT_FALSE(front.scan.speed || rear.scan.speed);
  front = timed_scan(1.2, Pose2{0.1, 0.0, 0.0}, 0);
  odometry.complete(front);
  ASSERT_TRUE(front.scan.speed);
  EXPECT_NEAR((*front.scan.speed)[0], 0.5, 1e-12);
}

ScanRecord swept_scan(double stamp_s, std::size_t laser = 0) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.scan.beam_period_s = 0.001;
  record.scan.ranges_m.assign(101, 1.0F);  // a tenth of a second
  record.laser = laser;
  return record;
}

TEST(ScanSpeed, WithoutOdometryTheMapTells) {
  MapSpeed map;
  ScanRecord record = swept_scan(2.2);
  map.take(swept_scan(2.0), {0.0, 0.0, 0.0});
  map.complete(record);
  EXPECT_FALSE(record.scan.speed);
  map.take(swept_scan(2.1), {0.05, 0.0, 0.0});
  map.complete(record);
  ASSERT_TRUE(record.scan.speed);
  EXPECT_NEAR((*record.scan.speed)[0], 0.5, 1e-9);
  ScanRecord at_once = record;
  at_once.scan.speed.reset();
  at_once.scan.beam_period_s = 0.0;
  map.complete(at_once);
  EXPECT_FALSE(at_once.scan.speed);
}

// A match finds where the middle of the sweep was seen from, so a wrong speed makes a pose at the stamp that is wrong
// by half a sweep of it. The next speed must not be wrong for that: one wrong match would go on and on.
TEST(ScanSpeed, OneWrongMatchIsForgotten) {
  MapSpeed map;
  for (int k = 0; k < 20; ++k) {
    ScanRecord record = swept_scan(0.1 * k);
    map.complete(record);
    const double seen_x_m = k == 5 ? 0.05 : 0.0;  // the robot stands still
    const double speed = record.scan.speed ? (*record.scan.speed)[0] : 0.0;
    map.take(record, {seen_x_m - 0.05 * speed, 0.0, 0.0});
    if (k > 8) {
      EXPECT_NEAR(speed, 0.0, 1e-9) << k;
    }
  }
}

// Two lasers that sweep within milliseconds of each other, matched to a millimetre: from one to the other is no speed.
TEST(ScanSpeed, ByPosesOfTheSameLaser) {
  MapSpeed map;
  for (int k = 0; k < 20; ++k) {
    for (const std::size_t laser : {0U, 1U}) {
      ScanRecord record = swept_scan(0.1 * k + 0.002 * static_cast<double>(laser), laser);
      map.complete(record);
      EXPECT_EQ(record.scan.speed.has_value(), k > 1) << laser;
      const double speed = record.scan.speed ? (*record.scan.speed)[0] : 0.0;
      if (k > 1) {
        EXPECT_NEAR(speed, 0.5, 0.05) << k << " " << laser;
      }
      const double missed_m = (k + static_cast<int>(laser)) % 2 == 0 ? 0.001 : -0.001;
      const double middle_x_m = 0.5 * (record.scan.stamp_s + 0.05) + missed_m;
      map.take(record, {middle_x_m - 0.05 * speed, 0.0, 0.0});
    }
  }
}

}  // namespace
}  // namespace gdtslam

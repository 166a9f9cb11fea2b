// Logs of several lasers on one robot: each is compared with itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "checked_log.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Pose2 kFront{0.3, 0.0, 0.0};
const Pose2 kRear{-0.3, 0.0, kPi};

// Each sweeps ten times a second, the rear one 5 ms later, and the odometry comes once for both.
std::vector<LogRecord> two_lasers(int sweeps) {
  std::vector<LogRecord> records;
  for (int k = 0; k < sweeps; ++k) {
    ScanRecord front = driven_scan(0.1 * k, {0.05 * k, 0.0, 0.0});
    front.scan.T_base_laser = kFront;
    ScanRecord rear = driven_scan(0.1 * k + 0.005, {0.05 * k, 0.0, 0.0}, {1.0F, 2.0F, 3.0F, 4.0F});
    rear.scan.T_base_laser = kRear;
    rear.laser = 1;
    records.emplace_back(front);
    records.emplace_back(rear);
  }
  return records;
}

ScanRecord& scan_number(std::vector<LogRecord>& records, std::size_t index) {
  return std::get<ScanRecord>(records[index]);
}

TEST(LogCheckLasers, EachHasItsRateItsBeamsAndItsPlace) {
  const LogCheck check = checked_log(two_lasers(50));
  EXPECT_NEAR(check.median_step_s, 0.1, 1e-12);
  EXPECT_NEAR(check.usual_step_s, 0.1, 1e-12);
  EXPECT_NEAR(check.duration_s(), 4.905, 1e-9);
  EXPECT_EQ(check.still_scans, 0U);
  EXPECT_NEAR(check.path_m, 2.45, 1e-9);
  ASSERT_EQ(check.lasers.size(), 2U);
  for (const std::size_t laser : {0U, 1U}) {
    EXPECT_EQ(check.lasers[laser].laser, laser);
    EXPECT_EQ(check.lasers[laser].scans, 50U);
    EXPECT_EQ(check.lasers[laser].changes, 0U);
    EXPECT_EQ(check.lasers[laser].T_base_laser, laser == 0 ? kFront : kRear);
    EXPECT_EQ(check.layouts[laser].laser, laser);
    EXPECT_EQ(check.layouts[laser].scans, 50U);
  }
  EXPECT_THAT(check.suggestions(), IsEmpty());
}

TEST(LogCheckLasers, StampsOfOneSayNothingOfTheOther) {
  std::vector<LogRecord> records = two_lasers(10);
  scan_number(records, 7).scan.stamp_s = scan_number(records, 6).scan.stamp_s;         // both at once
  scan_number(records, 9).scan.stamp_s = scan_number(records, 8).scan.stamp_s - 0.01;  // the rear one first
  EXPECT_EQ(checked_log(records).repeated_stamps.count + checked_log(records).backward_stamps.count, 0U);
  scan_number(records, 11).scan.stamp_s = scan_number(records, 9).scan.stamp_s;
  EXPECT_EQ(checked_log(records).repeated_stamps.count, 1U);
  scan_number(records, 12).scan.stamp_s = scan_number(records, 10).scan.stamp_s - 0.01;
  ASSERT_EQ(checked_log(records).backward_stamps.count, 1U);
  EXPECT_NEAR(checked_log(records).backward_stamps.largest, 0.01, 1e-12);
}

// As where the scans of one stand in the file before those of the other.
TEST(LogCheckLasers, AStampFarBehindAnyIsAStepBack) {
  const auto backward = [](double back_s) {
    ScanRecord late = fixed_scan(10.0);
    ScanRecord early = fixed_scan(10.0 - back_s);
    early.laser = 1;
    return checked_log({fixed_scan(9.9), late, early}).backward_stamps;
  };
  EXPECT_EQ(backward(0.75).count, 0U);
  EXPECT_EQ(backward(1.0).count, 1U);
  EXPECT_EQ(backward(5.0).count, 1U);
  EXPECT_EQ(backward(5.0).first[0].scan, 2U);
  EXPECT_EQ(backward(5.0).largest, 5.0);
}

TEST(LogCheckLasers, AGapIsOneOfAllLasers) {
  std::vector<LogRecord> records = two_lasers(40);
  for (std::size_t index = 20; index < records.size(); ++index) scan_number(records, index).scan.stamp_s += 3.0;
  const LogCheck check = checked_log(records);
  ASSERT_EQ(check.gaps.count, 1U);
  EXPECT_EQ(check.gaps.first[0].scan, 20U);
  EXPECT_NEAR(check.gaps.largest, 3.095, 1e-9);
  std::vector<LogRecord> silent;
  const std::vector<LogRecord> all = two_lasers(40);
  for (std::size_t index = 0; index < all.size(); ++index) {
    const bool is_silent = index % 2 == 1 && index > 10 && index < 60;
    if (!is_silent) silent.push_back(all[index]);
  }
  EXPECT_EQ(checked_log(silent).gaps.count, 0U) << "the other one went on";
}

TEST(LogCheckLasers, TheOneThatMovesOrChangesIsNamed) {
  std::vector<LogRecord> records = two_lasers(10);
  scan_number(records, 5).scan.T_base_laser = {-0.3, 0.01, kPi};
  scan_number(records, 9).scan.T_base_laser = {-0.3, 0.0, kPi - rad_from_deg(1.0)};
  LogCheck check = checked_log(records);
  EXPECT_EQ(check.lasers[0].changes, 0U);
  EXPECT_EQ(check.lasers[1].changes, 2U);
  EXPECT_THAT(check.suggestions(), ElementsAre(HasSubstr("laser 1 moves on the robot")));
  records = two_lasers(10);
  scan_number(records, 4).scan.ranges_m.push_back(5.0F);  // as the rear one has, but of the front one
  check = checked_log(records);
  EXPECT_EQ(check.layouts.size(), 3U);
  EXPECT_THAT(check.suggestions(), ElementsAre(HasSubstr("the beams of laser 0 change")));
}

TEST(LogCheckLasers, NumbersBeyondBoundAreCountedWithTheLast) {
  std::vector<LogRecord> records;
  for (std::size_t laser = 0; laser < 1000; ++laser) {
    ScanRecord scan = fixed_scan(0.1 * static_cast<double>(laser));
    scan.laser = 7 * laser;
    records.emplace_back(scan);
  }
  const LogCheck check = checked_log(records);
  ASSERT_EQ(check.lasers.size(), 64U);
  EXPECT_EQ(check.lasers.back().laser, 7U * 63U);
  EXPECT_EQ(check.lasers.back().scans, 1000U - 63U);
  EXPECT_EQ(check.layouts.size(), 64U);
}

}  // namespace
}  // namespace gdtslam

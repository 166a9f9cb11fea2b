// Logs of several lasers on one robot: each is compared with itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "checked_log.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

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

}  // namespace
}  // namespace gdtslam

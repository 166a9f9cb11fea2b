// Each bound of the check of a log, at it and beside it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "checked_log.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Of scans whose steps are these, whole milliseconds.
LogCheck checked_steps(const std::vector<int>& steps_ms) {
  std::vector<LogRecord> records{fixed_scan(0.0)};
  int stamp_ms = 0;
  for (const int step_ms : steps_ms) {
    stamp_ms += step_ms;
    records.emplace_back(fixed_scan(1e-3 * stamp_ms));
  }
  return checked_log(records);
}

RangeStatistics ranges_of(std::vector<float> ranges_m) {
  return checked_log({fixed_scan(0.0, std::move(ranges_m))}).ranges;
}

void put(std::vector<float>& ranges_m, int centimetres, std::size_t times) {
  ranges_m.insert(ranges_m.end(), times, static_cast<float>(centimetres) / 100.0F);
}

TEST(LogCheckBounds, AGapIsASecondOrFiveUsualSteps) {
  std::vector<int> steps_ms(10, 100);
  steps_ms.push_back(999);
  EXPECT_EQ(checked_steps(steps_ms).gaps.count, 0U);
  EXPECT_THAT(checked_steps(steps_ms).gaps.first, IsEmpty());
  EXPECT_EQ(checked_steps(steps_ms).gaps.largest, 0.0);
  steps_ms.back() = 1000;
  EXPECT_EQ(checked_steps(steps_ms).gaps.count, 1U);
  EXPECT_NEAR(checked_steps(steps_ms).gap_bound_s, 1.0, 1e-12);
  steps_ms.assign(10, 400);
  steps_ms.push_back(1999);
  EXPECT_EQ(checked_steps(steps_ms).gaps.count, 0U);
  EXPECT_NEAR(checked_steps(steps_ms).gap_bound_s, 2.0, 1e-12);
  steps_ms.back() = 2000;
  EXPECT_EQ(checked_steps(steps_ms).gaps.count, 1U);
}

// All steps of ten seconds and more are counted as ten, so no bound is beyond.
TEST(LogCheckBounds, StepsBeyondTenSecondsAreGaps) {
  const LogCheck check = checked_steps({20'000, 20'000, 20'000, 30'000});
  EXPECT_NEAR(check.median_step_s, 10.0, 1e-12);
  EXPECT_NEAR(check.gap_bound_s, 10.0, 1e-12);
  EXPECT_EQ(check.gaps.count, 4U);
  EXPECT_NEAR(check.gaps.largest, 30.0, 1e-12);
  EXPECT_EQ(checked_steps({9'999, 9'999}).gaps.count, 0U);
}

TEST(LogCheckBounds, TheUsualStepIsTheMedian) {
  EXPECT_NEAR(checked_steps({100, 300, 100, 300, 100}).median_step_s, 0.1, 1e-12);
  EXPECT_NEAR(checked_steps({100, 300, 100, 300, 300}).median_step_s, 0.3, 1e-12);
  EXPECT_NEAR(checked_steps({100, 300, 100, 300}).median_step_s, 0.3, 1e-12) << "of two, the longer";
}

TEST(LogCheckBounds, WhatNoRobotMakesInATime) {
  const StepBounds bounds{.distance_m = 0.5,
                          .speed_m_s = 2.0,
                          .angle_rad = 0.25,
                          .turn_rate_rad_s = 1.0,
                          .longest_s = 2.0,
                          .unknown_s = 0.25};
  struct Case {
    double step_s, distance_m, angle_rad;
  };
  for (const Case& at : {Case{0.5, 1.5, 0.75}, {2.0, 4.5, 2.25}, {9.0, 4.5, 2.25}, {0.0, 1.0, 0.5}, {-3.0, 1.0, 0.5}}) {
    EXPECT_FALSE(is_impossible({at.distance_m, 0.0, at.angle_rad}, at.step_s, bounds)) << at.step_s;
    EXPECT_FALSE(is_impossible({0.0, -at.distance_m, -at.angle_rad}, at.step_s, bounds)) << at.step_s;
    EXPECT_TRUE(is_impossible({at.distance_m + 1e-9, 0.0, 0.0}, at.step_s, bounds)) << at.step_s;
    EXPECT_TRUE(is_impossible({0.0, 0.0, at.angle_rad + 1e-9}, at.step_s, bounds)) << at.step_s;
    EXPECT_TRUE(is_impossible({0.0, 0.0, -at.angle_rad - 1e-9}, at.step_s, bounds)) << at.step_s;
  }
}

TEST(LogCheckBounds, TurnsOfBothHandsAddUpAndStandingIsCounted) {
  const LogCheck check = checked_log({driven_scan(0.0, {}), driven_scan(1.0, {0.5, 0.0, 0.25}),
                                      driven_scan(2.0, {0.5, 0.0, 0.25}), driven_scan(3.0, {0.5, 0.0, -0.25}),
                                      driven_scan(4.0, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}),
                                      driven_scan(5.0, {0.5, 0.75, -0.25})});
  EXPECT_NEAR(check.path_m, 1.25, 1e-12);
  EXPECT_NEAR(check.turned_rad, 0.75, 1e-12);
  EXPECT_EQ(check.still_scans, 1U);
  EXPECT_EQ(check.scans_with_odometry, 6U);
}

// The two have frames of their own: from one to the other is no step.
TEST(LogCheckBounds, FromRecordsToTheScansOwnOdometryIsNoStep) {
  const LogCheck check =
      checked_log({Odometry{0.0, {}}, Odometry{1.0, {1.0, 0.0, 0.0}}, driven_scan(2.0, {50.0, 0.0, 0.0}),
                   Odometry{2.5, {9.0, 0.0, 0.0}}, driven_scan(3.0, {52.0, 0.0, 0.0})});
  EXPECT_EQ(check.impossible_steps.count, 0U);
  EXPECT_NEAR(check.path_m, 3.0, 1e-12);
  EXPECT_EQ(check.odometry_records, 3U);
}

TEST(LogCheckBounds, RangesAreRoundedToTheCentimetreAndOpenBeyond200m) {
  const RangeStatistics ranges = ranges_of({0.0F, 1.234F, 1.236F, 5.0F, 250.0F});
  EXPECT_NEAR(ranges.shortest_m, 1.23, 1e-9);
  EXPECT_NEAR(ranges.median_m, 5.0, 1e-9);
  EXPECT_NEAR(ranges.longest_m, 200.0, 1e-9);
  EXPECT_EQ(ranges.returns, 4U);
  EXPECT_EQ(ranges.beams, 5U);
  EXPECT_NEAR(ranges_of({1.236F, 1.236F, 199.99F}).longest_m, 199.99, 1e-9);
  EXPECT_NEAR(ranges_of({1.236F, 1.236F, 199.99F}).median_m, 1.24, 1e-9);
}

TEST(LogCheckBounds, WhatCountsAsAReturn) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  ScanRecord stated = fixed_scan(0.0, {kInfinity, -1.0F, 0.0F, 7.99F, 8.0F, 9.0F});
  stated.scan.max_range_m = 8.0;
  const LogCheck check = checked_log({stated, fixed_scan(1.0, {0.0F, -2.0F, kInfinity})});
  EXPECT_EQ(check.ranges.returns, 1U);
  EXPECT_EQ(check.ranges.no_return_count, 2U);
  EXPECT_EQ(check.ranges.not_finite, 6U);
  EXPECT_EQ(check.ranges.beams, 9U);
  EXPECT_EQ(check.scans_without_returns, 1U);
  ScanRecord beyond = fixed_scan(0.0, {8.0F, 0.0F});
  beyond.scan.max_range_m = 8.0;
  EXPECT_EQ(checked_log({beyond}).scans_without_returns, 1U);
}

TEST(LogCheckBounds, AConstantIsBeyondAMetreAndInTheUpperFifth) {
  EXPECT_THAT(ranges_of(std::vector<float>(20, 0.99F)).no_return_m, IsEmpty());
  EXPECT_THAT(ranges_of(std::vector<float>(20, 1.0F)).no_return_m, ElementsAre(DoubleNear(1.0, 1e-9)));
  std::vector<float> ranges_m;
  put(ranges_m, 8191, 20);
  put(ranges_m, 10'238, 1);  // four fifths of 10,239 bins are 8191
  EXPECT_THAT(ranges_of(ranges_m).no_return_m, ElementsAre(DoubleNear(81.91, 1e-9)));
  ranges_m.back() = 102.39F;
  EXPECT_THAT(ranges_of(ranges_m).no_return_m, IsEmpty());
}

TEST(LogCheckBounds, AMountMovesByAMillimetreOrATenthOfADegree) {
  const auto changes = [](const Pose2& T_base_laser) {
    ScanRecord moved = fixed_scan(1.0);
    moved.scan.T_base_laser = T_base_laser;
    return checked_log({fixed_scan(0.0), moved, fixed_scan(2.0)}).lasers.front().changes;
  };
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(changes({sign * 0.9e-3, 0.0, 0.0}), 0U);
    EXPECT_EQ(changes({0.0, sign * 1.1e-3, 0.0}), 1U);
    EXPECT_EQ(changes({0.0, 0.0, rad_from_deg(sign * 0.09)}), 0U);
    EXPECT_EQ(changes({0.0, 0.0, rad_from_deg(sign * 0.11)}), 1U);
  }
}

TEST(LogCheckBounds, OfAGoodLogNothingIsSaid) {
  std::vector<LogRecord> records;
  for (int k = 0; k < 10; ++k) records.emplace_back(driven_scan(0.1 * k, {0.05 * k, 0.0, 0.0}));
  EXPECT_THAT(checked_log(records).suggestions(), IsEmpty());
  EXPECT_THAT(checked_log({}).suggestions(), IsEmpty()) << "of odometry only where there are scans";
  LogCheck check = checked_log(records);
  check.warnings.push_back({"malformed line", 2, "line 3"});
  EXPECT_THAT(check.suggestions(), ElementsAre(HasSubstr("--lenient")));
  check.warnings.back().kind = "other";
  EXPECT_THAT(check.suggestions(), IsEmpty());
  records.emplace_back(driven_scan(1.0, {30.0, 0.0, 0.0}));
  EXPECT_THAT(checked_log(records).suggestions(), ElementsAre(HasSubstr("the odometry jumps")));
}

TEST(LogCheckBounds, MessagesOfTheMountHaveARateAndALongestGap) {
  NodChecker checker;
  for (const double stamp_s : {10.0, 10.25, 10.5, 10.25, 11.0})
    checker.add(Tilt{stamp_s, stamp_s < 10.4 ? 0.5 : -0.25});
  const NodCheck check = checker.finish();
  EXPECT_EQ(check.mean_rate_hz, 4.0);
  EXPECT_EQ(check.longest_gap_s, 0.5);
  EXPECT_EQ(check.longest_gap_at_s, 10.5);
  EXPECT_EQ(check.backward_stamps, 1U);
  EXPECT_EQ(check.lowest_tilt_rad, -0.25);
  EXPECT_EQ(check.highest_tilt_rad, 0.5);
  EXPECT_THAT(check.suggestions(), ElementsAre(HasSubstr("the laser tilts"), HasSubstr("for 0.500 s after 10.500000 s"),
                                               HasSubstr("go backward")));
}

}  // namespace
}  // namespace gdtslam

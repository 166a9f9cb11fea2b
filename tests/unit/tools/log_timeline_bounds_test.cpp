// Bins, times and bounds of the timeline of a log, where they follow by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/runs/streams/log_timeline.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::Pair;

ScanRecord stamped_scan(double stamp_s, std::vector<float> ranges_m = {2.0F}) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.scan.ranges_m = std::move(ranges_m);
  return record;
}

LogPicture drawn_of(const std::vector<LogRecord>& records, const LogCheck& check = {}) {
  LogTimeline timeline{StepBounds{}};
  for (const LogRecord& record : records) timeline.add(record);
  return timeline.picture(check, "test");
}

/// Scans every `step_s` from 100 s on, each but the first a little later, so that none is at the edge of a bin.
void add_scans(std::vector<LogRecord>& records, double step_s, int from, int to) {
  for (int k = from; k < to; ++k) records.emplace_back(stamped_scan(100.0 + step_s * k + (k > 0 ? 1e-3 : 0.0)));
}

/// Of scans all of whose returns are from such a range.
LogPicture::Ranges spread_of(std::vector<float> ranges_m) {
  return drawn_of({stamped_scan(0.0, std::move(ranges_m))}).ranges.at(0);
}

// An octave has 32 bins; within one the returns are taken as spread evenly.
TEST(LogTimelineBounds, QuantilesLieWithinTheBinOfARange) {
  for (const double octave_m : {0.03125, 0.5, 1.0, 512.0}) {
    const double bin_m = octave_m / 32.0;
    for (const int bin : {0, 1, 16, 31}) {
      const double begin_m = octave_m + bin * bin_m;
      const LogPicture::Ranges spread = spread_of({static_cast<float>(begin_m + 0.25 * bin_m)});
      EXPECT_NEAR(spread.least_m, begin_m + 0.05 * bin_m, 1e-9);
      EXPECT_NEAR(spread.lower_m, begin_m + 0.25 * bin_m, 1e-9);
      EXPECT_NEAR(spread.median_m, begin_m + 0.5 * bin_m, 1e-9);
      EXPECT_NEAR(spread.upper_m, begin_m + 0.75 * bin_m, 1e-9);
      EXPECT_NEAR(spread.most_m, begin_m + 0.95 * bin_m, 1e-9);
      EXPECT_NEAR(spread_of({static_cast<float>(begin_m)}).median_m, spread.median_m, 1e-9) << "where the bin begins";
    }
  }
}

TEST(LogTimelineBounds, RangesBeyondTheBinsAreInTheFirstOrTheLast) {
  for (const float range_m : {0.001F, 0.0312F})
    EXPECT_NEAR(spread_of({range_m}).median_m, 0.03125 * (1 + 0.5 / 32), 1e-9);
  for (const float range_m : {1024.0F, 5000.0F})
    EXPECT_NEAR(spread_of({range_m}).median_m, 512.0 * (2 - 0.5 / 32), 1e-9);
}

TEST(LogTimelineBounds, AQuantileBetweenTwoBinsIsWhereTheFirstEnds) {
  const LogPicture::Ranges spread = spread_of({1.0F, 1.0F, 4.0F, 4.0F});
  EXPECT_NEAR(spread.median_m, 1.0 + 1.0 / 32, 1e-9);
  EXPECT_NEAR(spread.lower_m, 1.0 + 0.5 / 32, 1e-9);
  EXPECT_NEAR(spread.upper_m, 4.0 * (1.0 + 0.5 / 32), 1e-9);
}

TEST(LogTimelineBounds, WhatIsFartherThanStatedIsMissing) {
  ScanRecord scan = stamped_scan(0.0, {1.0F, 4.99F, 5.0F, 6.0F, 0.0F});
  EXPECT_NEAR(drawn_of({scan}).missing_percent.at(0).y(), 20.0, 1e-9);
  scan.scan.max_range_m = 5.0;
  EXPECT_NEAR(drawn_of({scan}).missing_percent.at(0).y(), 60.0, 1e-9);
  EXPECT_TRUE(std::isnan(drawn_of({stamped_scan(0.0, {})}).missing_percent.at(0).y()));
}

// Bins of 0.05 s stay as they are where each has two scans.
TEST(LogTimelineBounds, TwoScansABinAreEnough) {
  std::vector<LogRecord> records;
  add_scans(records, 0.025, 0, 200);
  const LogPicture picture = drawn_of(records);
  ASSERT_EQ(picture.ranges.size(), 100U);
  EXPECT_NEAR(picture.ranges[0].time_s, 0.025, 1e-9);
  EXPECT_NEAR(picture.ranges[99].time_s, 4.975, 1e-9);
  EXPECT_NEAR(picture.length, 199 * 0.025 + 1e-3, 1e-9);
}

// 5.0 s more in the 101st bin: 200 scans in 101 bins are less than two each.
TEST(LogTimelineBounds, FewerThanTwoAreJoined) {
  std::vector<LogRecord> records;
  add_scans(records, 0.025, 0, 199);
  records.emplace_back(stamped_scan(105.001));
  const LogPicture picture = drawn_of(records);
  ASSERT_EQ(picture.ranges.size(), 51U);
  EXPECT_NEAR(picture.ranges[1].time_s, 0.15, 1e-9);
}

// 53 scans in 521 bins of 0.1 s: 32 are joined for two scans each; 52 in 1021 of 0.05 s, then 64.
TEST(LogTimelineBounds, BinsDoubleWhenTheyBecomeTooMany) {
  std::vector<LogRecord> records;
  add_scans(records, 1.0, 0, 53);
  const LogPicture picture = drawn_of(records);
  ASSERT_EQ(picture.ranges.size(), 17U);
  EXPECT_NEAR(picture.ranges[0].time_s, 1.6, 1e-9);
  EXPECT_NEAR(picture.ranges[16].time_s, 1.6 + 16 * 3.2, 1e-9);
  records.clear();
  add_scans(records, 1.0, 0, 52);  // the last at 51.001 s, in the last of 1024 bins of 0.05 s
  EXPECT_EQ(drawn_of(records).ranges.size(), 16U);
  EXPECT_NEAR(drawn_of(records).ranges.at(0).time_s, 1.6, 1e-9);
}

// 16 scans in 1.6 s, none from 20 s to 40 s, and a last bin of which more or less than half is there.
TEST(LogTimelineBounds, RatesGoFromTheLastScanOfABinToThatOfTheNext) {
  std::vector<LogRecord> records;
  add_scans(records, 0.1, 0, 200);
  add_scans(records, 0.1, 400, 600);
  LogCheck check;
  check.median_step_s = 0.1;
  std::vector<Point2> rates_hz = drawn_of(records, check).rates_hz;
  ASSERT_EQ(rates_hz.size(), 38U) << "the last bin, from 59.2 s, ends at 59.9 s";
  EXPECT_NEAR(rates_hz[0].x(), 0.0, 1e-9);
  EXPECT_NEAR(rates_hz[0].y(), 16 / 1.601, 1e-6);
  EXPECT_NEAR(rates_hz[1].x(), 1.6, 1e-9);
  EXPECT_NEAR(rates_hz[1].y(), 10.0, 1e-6);
  EXPECT_NEAR(rates_hz[12].y(), 10.0, 1e-6) << "8 scans of 0.8 s";
  for (std::size_t k = 13; k < 25; ++k) EXPECT_EQ(rates_hz[k].y(), 0.0);
  EXPECT_NEAR(rates_hz[25].x(), 40.0, 1e-9);
  EXPECT_NEAR(rates_hz[25].y(), 16 / 1.501, 1e-6);
  EXPECT_NEAR(rates_hz[26].y(), 10.0, 1e-6);
  EXPECT_NEAR(rates_hz[37].x(), 59.901, 1e-9);
  EXPECT_EQ(rates_hz[37].y(), rates_hz[36].y());
  add_scans(records, 0.1, 600, 602);
  EXPECT_EQ(drawn_of(records, check).rates_hz.size(), 39U);
}

TEST(LogTimelineBounds, AScanBeforeTheFirstIsCountedWithIt) {
  const LogPicture picture = drawn_of({stamped_scan(100.0, {1.0F}), stamped_scan(90.0, {0.0F})});
  ASSERT_EQ(picture.ranges.size(), 1U);
  EXPECT_NEAR(picture.missing_percent[0].y(), 50.0, 1e-9);
  EXPECT_EQ(picture.length, 1.0);
  LogTimeline timeline{StepBounds{}};
  timeline.add(stamped_scan(100.0));
  timeline.add(stamped_scan(90.0));
  EXPECT_FALSE(timeline.has_length());
  timeline.add(stamped_scan(100.5));
  EXPECT_TRUE(timeline.has_length());
}

TEST(LogTimelineBounds, AStrayIsTwoMillionSecondsAway) {
  EXPECT_EQ(drawn_of({stamped_scan(0.0), stamped_scan(1'999'999.0)}).length, 1'999'999.0);
  const LogPicture picture =
      drawn_of({stamped_scan(0.0), stamped_scan(2.0e6), stamped_scan(-2.0e6), stamped_scan(5.0)});
  EXPECT_EQ(picture.length, 5.0);
  EXPECT_THAT(picture.subtitle, HasSubstr("; 2 scans stamped weeks away left out"));
}

TEST(LogTimelineBounds, TwentyStraysInARowAreBelieved) {
  std::vector<LogRecord> records;
  for (int k = 0; k < 5; ++k) records.emplace_back(stamped_scan(0.1 * k));
  for (int k = 0; k < 19; ++k) records.emplace_back(stamped_scan(1e9 + 0.1 * k));
  std::vector<LogRecord> in_two_rows = records;
  records.emplace_back(stamped_scan(1e9 + 10.0));
  records.emplace_back(stamped_scan(1e9 + 17.0));
  const LogPicture believed = drawn_of(records);
  EXPECT_EQ(believed.length, 7.0);
  EXPECT_THAT(believed.subtitle, HasSubstr("; 24 scans stamped weeks away"));
  in_two_rows.emplace_back(stamped_scan(3.0));
  for (int k = 0; k < 19; ++k) in_two_rows.emplace_back(stamped_scan(1e9 + 0.1 * k));
  const LogPicture not_believed = drawn_of(in_two_rows);
  EXPECT_EQ(not_believed.length, 3.0);
  EXPECT_THAT(not_believed.subtitle, HasSubstr("; 38 scans stamped weeks away"));
}

ScanRecord driven_at(double stamp_s, const Pose2& T_odom_base) {
  ScanRecord record = stamped_scan(stamp_s);
  record.T_odom_base = T_odom_base;
  return record;
}

// The poses of two clocks are no step: else the first speed would be that of thirty years.
TEST(LogTimelineBounds, FromAStampThatWasWrongThereIsNoStep) {
  std::vector<LogRecord> records{driven_at(0.0, {})};
  for (int k = 0; k < 200; ++k)
    records.emplace_back(driven_at(1e9 + 0.025 * k + (k > 19 ? 1e-3 : 0.0), {0.025 * k, 0.0, 0.0}));
  const LogPicture picture = drawn_of(records);
  ASSERT_FALSE(picture.speeds_m_s.empty());
  EXPECT_NEAR(picture.speeds_m_s[0].y(), 1.0, 0.05);
}

// 1 m/s to the right for two seconds; then nothing for four, which has no speed.
TEST(LogTimelineBounds, MotionIsThatOfTheStepsThatEndInABin) {
  std::vector<LogRecord> records;
  for (int k = 0; k <= 80; ++k) {
    records.emplace_back(driven_at(0.025 * k + (k > 0 ? 1e-3 : 0.0), {0.025 * k, 0.0, -0.0125 * k}));
  }
  for (int k = 81; k < 400; ++k) records.emplace_back(stamped_scan(0.025 * k + 1e-3));
  const LogPicture picture = drawn_of(records);
  ASSERT_EQ(picture.speeds_m_s.size(), 200U);
  for (std::size_t k = 1; k <= 39; ++k) {
    EXPECT_NEAR(picture.speeds_m_s[k].y(), 1.0, 1e-6);
    EXPECT_NEAR(picture.turns_deg_s[k].y(), deg_from_rad(-0.5), 1e-6);
    EXPECT_NEAR(picture.turns_deg_s[k].x(), 0.05 * (static_cast<double>(k) + 0.5), 1e-9);
  }
  EXPECT_TRUE(std::isnan(picture.speeds_m_s[41].y()));
  EXPECT_TRUE(std::isnan(picture.turns_deg_s[199].y()));
  EXPECT_NEAR(picture.speeds_m_s[199].x(), 9.975, 1e-9);
}

TEST(LogTimelineBounds, OdometryBetweenScansCountsWhereTheyHaveNone) {
  const std::vector<LogRecord> records{Odometry{0.0, {99.0, 0.0, 0.0}}, stamped_scan(0.0),
                                       Odometry{0.0, {1.0, 0.0, 0.0}},  Odometry{0.5, {2.0, 0.0, 0.0}},
                                       Odometry{0.5, {9.0, 0.0, 0.0}},  Odometry{2.1e6, {9.0, 0.0, 0.0}},
                                       Odometry{1.5, {10.0, 0.0, 0.0}}, stamped_scan(1.501)};
  const LogPicture picture = drawn_of(records);
  ASSERT_EQ(picture.speeds_m_s.size(), 1U);
  EXPECT_NEAR(picture.speeds_m_s[0].y(), 2.0 / 1.5, 1e-9)
      << "a metre in 0.5 s, then, from where it was set, one in 1 s";
  std::vector<LogRecord> own = records;
  own.insert(own.end(),
             {driven_at(2.0, {10.5, 0.0, 0.0}), Odometry{2.1, {11.0, 0.0, 0.0}}, driven_at(3.0, {12.5, 0.0, 0.0})});
  ASSERT_EQ(drawn_of(own).speeds_m_s.size(), 2U);
  EXPECT_NEAR(drawn_of(own).speeds_m_s[0].y(), 2.0 / 1.5, 1e-9);
  EXPECT_NEAR(drawn_of(own).speeds_m_s[1].y(), 2.0, 1e-9) << "from the first of their own on, and of those alone";
}

// Four angles in a bin of 0.1 s, the first of them neither the least nor the most.
TEST(LogTimelineBounds, TwoElevationsABinAreEnough) {
  std::vector<LogRecord> records{Tilt{-1.0, 1.5}};
  for (int k = 0; k < 40; ++k) {
    records.emplace_back(stamped_scan(0.1 * k + (k > 0 ? 1e-3 : 0.0)));
    int at = 0;
    for (const double elevation_rad : {0.125, 0.5, -0.25, 0.25}) {
      records.emplace_back(Tilt{0.1 * k + 2e-3 + 0.025 * at++, elevation_rad});
    }
  }
  records.emplace_back(Tilt{2.1e6, 1.5});
  records.emplace_back(Tilt{1.0, std::nan("")});
  const LogPicture picture = drawn_of(records);
  ASSERT_EQ(picture.elevations_deg.size(), 80U);
  for (std::size_t k = 0; k < 80; ++k) {
    EXPECT_NEAR(picture.elevations_deg[k].first.x(), 0.05 * (static_cast<double>(k) + 0.5), 1e-9);
    EXPECT_NEAR(picture.elevations_deg[k].first.y(), deg_from_rad(k % 2 == 0 ? 0.125 : -0.25), 1e-9);
    EXPECT_NEAR(picture.elevations_deg[k].second.y(), deg_from_rad(k % 2 == 0 ? 0.5 : 0.25), 1e-9);
  }
}

// A stretch that has one is joined with one that has none: the other's extent alone counts.
TEST(LogTimelineBounds, AStretchWithoutElevationsAddsNone) {
  const std::vector<LogRecord> records{stamped_scan(0.0), Tilt{0.01, 0.5}, stamped_scan(0.5), Tilt{0.36, 0.25},
                                       stamped_scan(0.99)};
  const LogPicture picture = drawn_of(records);
  ASSERT_EQ(picture.elevations_deg.size(), 1U);
  EXPECT_NEAR(picture.elevations_deg[0].first.x(), 0.8, 1e-9);
  EXPECT_NEAR(picture.elevations_deg[0].first.y(), deg_from_rad(0.25), 1e-9);
  EXPECT_NEAR(picture.elevations_deg[0].second.y(), deg_from_rad(0.5), 1e-9);
}

TEST(LogTimelineBounds, EventsAreThoseOfTheTimeThatIsShown) {
  LogCheck check;
  for (const double stamp_s : {100.0, 104.0, 110.0, 110.5}) {
    check.gaps.first.push_back({.stamp_s = stamp_s, .time_step_s = 1.5});
    check.impossible_steps.first.push_back({.stamp_s = stamp_s});
  }
  check.impossible_steps.first.push_back({.stamp_s = 99.5});
  const LogPicture picture = drawn_of({stamped_scan(100.0), stamped_scan(110.0)}, check);
  EXPECT_THAT(picture.gaps_s, ElementsAre(Pair(2.5, 4.0), Pair(8.5, 10.0)));
  EXPECT_THAT(picture.jumps_s, ElementsAre(0.0, 4.0, 10.0));
}

TEST(LogTimelineBounds, TheSubtitleSaysWhatThereIs) {
  const std::vector<LogRecord> records{stamped_scan(0.0), stamped_scan(12.34)};
  LogCheck check;
  check.scans = 2;
  EXPECT_EQ(drawn_of(records, check).subtitle, "2 scans in 12.3 s; no odometry");
  check.odometry_records = 1;
  EXPECT_EQ(drawn_of(records, check).subtitle, "2 scans in 12.3 s; the odometry stands still");
  check.odometry_records = 0;
  check.scans_with_odometry = 1;
  EXPECT_EQ(drawn_of(records, check).subtitle, "2 scans in 12.3 s; the odometry stands still");
  check.path_m = 0.04;
  check.turned_rad = rad_from_deg(90.0);
  EXPECT_EQ(drawn_of(records, check).subtitle, "2 scans in 12.3 s; 0.0 m driven, 90 deg turned by odometry");
  check.gaps.count = 20;
  check.gap_bound_s = 1.5;
  EXPECT_THAT(drawn_of(records, check).subtitle, AllOf(HasSubstr("; 20 gaps longer than 1.5 s"), Not(HasSubstr("("))));
  check.gaps.count = 21;
  EXPECT_THAT(drawn_of(records, check).subtitle, HasSubstr("; 21 gaps longer than 1.5 s (the longest 20 are marked)"));
}

TEST(LogTimelineBounds, WithoutAScanThereIsNothing) {
  const LogPicture picture = drawn_of({Odometry{0.0, {}}, Odometry{1.0, {1.0, 0.0, 0.0}}, Tilt{0.5, 0.1}});
  EXPECT_THAT(picture.ranges, IsEmpty());
  EXPECT_THAT(picture.speeds_m_s, IsEmpty());
  EXPECT_THAT(picture.elevations_deg, IsEmpty());
  EXPECT_EQ(picture.length, 1.0);
}

}  // namespace
}  // namespace gdtslam

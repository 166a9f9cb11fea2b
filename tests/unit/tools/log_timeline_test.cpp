// Logs whose rate, motion and ranges are known at every time; what the picture shows of them follows by hand.
#include "engine/runs/streams/log_timeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

/// Ranges that fill 1 to 5 m evenly.
std::vector<float> even_ranges(int beams) {
  std::vector<float> ranges_m;
  ranges_m.reserve(static_cast<std::size_t>(beams));
  for (int k = 0; k < beams; ++k) ranges_m.push_back(static_cast<float>(1.0 + 4.0 * (k + 0.5) / beams));
  return ranges_m;
}

ScanRecord timed_scan(double stamp_s, std::vector<float> ranges_m) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.scan.bearing_step_rad = 0.01;
  record.scan.ranges_m = std::move(ranges_m);
  return record;
}

LogPicture picture_of(const std::vector<LogRecord>& records) {
  LogTimeline timeline{StepBounds{}};
  LogChecker checker{StepBounds{}};
  for (const LogRecord& record : records) {
    timeline.add(record);
    checker.add(record);
  }
  return timeline.picture(checker.finish({}), "test");
}

/// Scans every 0.1 s of a robot that drives 0.5 m/s and turns 0.2 rad/s.
std::vector<LogRecord> even_drive(int scans) {
  std::vector<LogRecord> records;
  records.reserve(static_cast<std::size_t>(scans));
  for (int k = 0; k < scans; ++k) {
    ScanRecord scan = timed_scan(1000.0 + 0.1 * k, even_ranges(40));
    const double angle_rad = 0.02 * k;
    scan.T_odom_base = Pose2{2.5 * std::sin(angle_rad), 2.5 * (1.0 - std::cos(angle_rad)), angle_rad};
    records.emplace_back(std::move(scan));
  }
  return records;
}

TEST(LogTimeline, AnEvenDriveIsLevel) {
  for (const int scans : {40, 900, 20000}) {
    const LogPicture picture = picture_of(even_drive(scans));
    EXPECT_NEAR(picture.length, 0.1 * (scans - 1), 1e-6);
    EXPECT_LE(picture.rates_hz.size(), 513U) << scans;
    EXPECT_LE(picture.ranges.size(), 512U) << scans;
    EXPECT_GE(picture.ranges.size(), scans < 100 ? 10U : 200U) << scans;
    for (const Point2& rate : picture.rates_hz) EXPECT_NEAR(rate.y(), 10.0, 0.01) << scans;
    for (const Point2& speed : picture.speeds_m_s) EXPECT_NEAR(speed.y(), 0.5, 0.01) << scans;
    for (const Point2& turn : picture.turns_deg_s) EXPECT_NEAR(turn.y(), deg_from_rad(0.2), 0.01) << scans;
    for (const Point2& missing : picture.missing_percent) EXPECT_EQ(missing.y(), 0.0);
    for (const LogPicture::Ranges& ranges : picture.ranges) {
      EXPECT_NEAR(ranges.least_m, 1.2, 0.1);
      EXPECT_NEAR(ranges.lower_m, 2.0, 0.1);
      EXPECT_NEAR(ranges.median_m, 3.0, 0.1);
      EXPECT_NEAR(ranges.upper_m, 4.0, 0.1);
      EXPECT_NEAR(ranges.most_m, 4.8, 0.15);
    }
    EXPECT_THAT(picture.gaps_s, IsEmpty());
    EXPECT_THAT(picture.jumps_s, IsEmpty());
    EXPECT_THAT(picture.elevations_deg, IsEmpty());
  }
}

TEST(LogTimeline, GapsAndJumpsHaveTheirTimes) {
  std::vector<LogRecord> records = even_drive(400);
  for (std::size_t k = 200; k < records.size(); ++k) {
    auto& scan = std::get<ScanRecord>(records[k]);
    scan.scan.stamp_s += 5.0;
    if (k >= 300) scan.T_odom_base->x_m += 10.0;
  }
  const LogPicture picture = picture_of(records);
  ASSERT_THAT(picture.gaps_s, SizeIs(1));
  EXPECT_NEAR(picture.gaps_s[0].first, 19.9, 1e-6);
  EXPECT_NEAR(picture.gaps_s[0].second, 25.0, 1e-6);
  ASSERT_THAT(picture.jumps_s, SizeIs(1));
  EXPECT_NEAR(picture.jumps_s[0], 35.0, 1e-6);
  for (const Point2& speed : picture.speeds_m_s) EXPECT_FALSE(speed.y() > 0.51) << "the jump is no speed";
}

// Told to the centimetre; the picture's bins have an edge at 10 m and at 30 m.
TEST(LogTimeline, AConstantBesideTheEdgeOfABinIsMissingToo) {
  for (const float constant_m : {9.998F, 10.0F, 10.002F, 29.998F}) {
    std::vector<LogRecord> records;
    for (int k = 0; k < 200; ++k) {
      std::vector<float> ranges_m = even_ranges(60);
      ranges_m.insert(ranges_m.end(), 60, constant_m);
      records.emplace_back(timed_scan(0.1 * k, std::move(ranges_m)));
    }
    for (const Point2& missing : picture_of(records).missing_percent)
      EXPECT_NEAR(missing.y(), 50.0, 1e-9) << constant_m;
  }
}

TEST(LogTimeline, AWrongBeginDoesNotLeaveItCoarse) {
  std::vector<LogRecord> records;
  for (int k = 0; k < 60; ++k) records.emplace_back(timed_scan(60.0 * k, even_ranges(60)));
  for (int k = 0; k < 400; ++k) records.emplace_back(timed_scan(1.6e9 + 0.1 * k, even_ranges(60)));
  EXPECT_GT(picture_of(records).ranges.size(), 100U);
}

TEST(LogTimeline, WhatHasNoReturnIsMissing) {
  std::vector<LogRecord> records;
  for (int k = 0; k < 200; ++k) {
    std::vector<float> ranges_m = even_ranges(60);
    ranges_m.insert(ranges_m.end(), 10, 81.91F);  // a constant that nobody states
    ranges_m.insert(ranges_m.end(), 10, 0.0F);
    ranges_m.insert(ranges_m.end(), 10, std::numeric_limits<float>::infinity());
    ranges_m.insert(ranges_m.end(), 10, std::numeric_limits<float>::quiet_NaN());
    records.emplace_back(timed_scan(0.1 * k, std::move(ranges_m)));
  }
  const LogPicture picture = picture_of(records);
  for (const Point2& missing : picture.missing_percent) EXPECT_NEAR(missing.y(), 40.0, 1e-9);
  for (const LogPicture::Ranges& ranges : picture.ranges) EXPECT_NEAR(ranges.most_m, 4.8, 0.15);
  EXPECT_THAT(picture.speeds_m_s, IsEmpty());
  EXPECT_THAT(picture.turns_deg_s, IsEmpty());
}

TEST(LogTimeline, StraysDoNotStretchIt) {
  std::vector<LogRecord> records = even_drive(100);
  std::get<ScanRecord>(records[50]).scan.stamp_s = 4.0e9;
  EXPECT_NEAR(picture_of(records).length, 9.9, 1e-6);
  records = even_drive(100);
  std::get<ScanRecord>(records[0]).scan.stamp_s = -4.0e9;
  const LogPicture late = picture_of(records);
  EXPECT_NEAR(late.length, 9.9, 2.1) << "after twenty scans it is the first one that is believed wrong";
  EXPECT_THAT(late.subtitle, testing::HasSubstr("stamped weeks away"));
}

TEST(LogTimeline, WithoutTimeItGoesAlongTheScans) {
  LogTimeline timeline{StepBounds{}, LogTimeline::Along::kScans};
  LogChecker checker{StepBounds{}};
  for (int k = 0; k < 3000; ++k) {
    const LogRecord record = timed_scan(7.0, even_ranges(k < 1500 ? 40 : 20));
    timeline.add(record);
    checker.add(record);
  }
  const LogPicture picture = timeline.picture(checker.finish({}), "test");
  EXPECT_EQ(picture.length, 2999.0);
  EXPECT_FALSE(picture.is_by_time);
  EXPECT_THAT(picture.rates_hz, IsEmpty());
  ASSERT_GE(picture.ranges.size(), 250U);
  EXPECT_NEAR(picture.ranges.front().median_m, 3.0, 0.1);
  EXPECT_THAT(picture.subtitle, testing::HasSubstr("3,000 scans, all of one stamp"));
}

TEST(LogTimeline, ElevationsHaveTheirExtent) {
  std::vector<LogRecord> records;
  for (int k = 0; k < 100; ++k) {
    records.emplace_back(timed_scan(0.1 * k, even_ranges(30)));
    records.emplace_back(Tilt{.stamp_s = 0.1 * k, .elevation_rad = k % 2 == 0 ? 0.5 : -0.25});
  }
  const LogPicture picture = picture_of(records);
  ASSERT_FALSE(picture.elevations_deg.empty());
  double lowest_deg = 90.0;
  double highest_deg = -90.0;
  for (const auto& [least, most] : picture.elevations_deg) {
    EXPECT_LE(least.y(), most.y());
    lowest_deg = std::min(lowest_deg, least.y());
    highest_deg = std::max(highest_deg, most.y());
  }
  EXPECT_NEAR(lowest_deg, deg_from_rad(-0.25), 1e-9);
  EXPECT_NEAR(highest_deg, deg_from_rad(0.5), 1e-9);
}

}  // namespace
}  // namespace gdtslam

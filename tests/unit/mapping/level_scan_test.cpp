// Scans of a nodding laser near horizontal, in the plane.
#include "engine/mapping/nodding/horizontal_scans.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kElevation_rad = 0.1;

// Beams at -90, 0 and 90 deg, the plane raised by kElevation_rad.
NoddingScan raised(const std::vector<float>& ranges_m) {
  NoddingScan scan;
  scan.record.scan = {.stamp_s = 1.0,
                      .first_bearing_rad = -kPi / 2.0,
                      .bearing_step_rad = kPi / 2.0,
                      .max_range_m = 20.0,
                      .ranges_m = ranges_m,
                      .T_base_laser = {0.1, 0.0, 0.0}};
  const Phase phase = phase_of_elevation(kElevation_rad);
  scan.knots = {{0.0, phase}, {0.0, phase}};
  return scan;
}

NoddingScanner scanner() { return {{.height_m = 0.4}, ElevationTable::identity(), 0.0, 0.5}; }

TEST(LevelScan, ForwardRangesShrinkByTheCosineSidewaysOnesStay) {
  const LaserScan level = level_scan(raised({3.0F, 4.0F, 5.0F}), scanner());
  EXPECT_NEAR(static_cast<double>(level.ranges_m[0]), 3.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(level.ranges_m[1]), 4.0 * std::cos(kElevation_rad), 1e-6);
  EXPECT_NEAR(static_cast<double>(level.ranges_m[2]), 5.0, 1e-6);
}

// A reading at the sensor's limit is no return; shortened it would become a wall.
TEST(LevelScan, WhatIsNoReturnStaysNone) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const LaserScan level = level_scan(raised({nan, 20.0F, 65.5F}), scanner());
  EXPECT_TRUE(std::isnan(level.ranges_m[0]));
  EXPECT_EQ(level.ranges_m[1], 20.0F);
  EXPECT_EQ(level.ranges_m[2], 65.5F);
}

TEST(LevelPoints, AreTheBeamsEndsOverTheFloorWithinTheBand) {
  const ScanConfig valid;
  const NoddingScan scan = raised({3.0F, 4.0F, 20.0F});
  const PointScan all = level_points(scan, scanner(), valid, std::nullopt);
  ASSERT_EQ(all.points_base_m.size(), 2U);  // the third is no return
  EXPECT_NEAR(all.points_base_m[0].y(), -3.0, 1e-9);
  EXPECT_NEAR(all.points_base_m[1].x(), 0.1 + 4.0 * std::cos(kElevation_rad), 1e-6);
  const PointScan low = level_points(scan, scanner(), valid, std::nullopt, {.low_m = -0.1, .high_m = 0.2});
  ASSERT_EQ(low.points_base_m.size(), 1U);  // the forward one lies 4 m * sin 0.1 = 0.40 m higher
  EXPECT_NEAR(low.points_base_m[0].y(), -3.0, 1e-9);
}

}  // namespace
}  // namespace gdtslam

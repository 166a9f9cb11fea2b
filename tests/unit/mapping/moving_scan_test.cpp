// Scans whose beams were measured one after the other while the robot moved. Expected places come from the motion in
// closed form: along a straight line, and on the spot.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr ScanConfig kAllReturns{.min_range_m = 0.1, .max_range_m = 40.0};

LaserScan moving_scan(std::vector<float> ranges_m, const Eigen::Vector3d& speed) {
  LaserScan scan;
  scan.first_bearing_rad = -kPi / 2;
  scan.bearing_step_rad = kPi / 2;
  scan.first_beam_after_s = -0.1;
  scan.beam_period_s = 0.1;
  scan.speed = speed;
  scan.ranges_m = std::move(ranges_m);
  return scan;
}

TEST(MovingScan, AlongALineEachBeamStartsWhereTheLaserWas) {
  // 2 m/s ahead: 0.2 m behind, at, and 0.2 m ahead of where it is at the stamp; the laser sits 0.5 m ahead.
  LaserScan scan = moving_scan({1.0F, 2.0F, 3.0F}, {2.0, 0.0, 0.0});
  scan.T_base_laser = {0.5, 0.0, 0.0};
  const std::vector<Point2> points = to_points(scan, kAllReturns);
  ASSERT_EQ(points.size(), 3U);
  EXPECT_LT((points[0] - Point2(0.3, -1.0)).norm(), 1e-12);
  EXPECT_LT((points[1] - Point2(2.5, 0.0)).norm(), 1e-12);
  EXPECT_LT((points[2] - Point2(0.7, 3.0)).norm(), 1e-12);
}

TEST(MovingScan, OnTheSpotEachBeamIsTurned) {
  const double rate = 0.5;
  const std::vector<Point2> points = to_points(moving_scan({1.0F, 1.0F, 1.0F}, {0.0, 0.0, rate}), kAllReturns);
  ASSERT_EQ(points.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const double at = static_cast<double>(k) - 1.0;
    const double bearing = at * kPi / 2 + rate * 0.1 * at;
    EXPECT_LT((points[k] - Point2(std::cos(bearing), std::sin(bearing))).norm(), 1e-12) << k;
  }
}

TEST(MovingScan, WithoutASpeedOrTimesAllIsMeasuredAtTheStamp) {
  LaserScan still = moving_scan({1.0F, 2.0F, 3.0F}, {2.0, 0.0, 1.0});
  LaserScan unknown = still;
  unknown.speed.reset();
  still.first_beam_after_s = still.beam_period_s = 0.0;
  const std::vector<Point2> expected{{0.0, -1.0}, {2.0, 0.0}, {0.0, 3.0}};
  for (const LaserScan& scan : {still, unknown}) {
    const std::vector<Point2> points = to_points(scan, kAllReturns);
    ASSERT_EQ(points.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT((points[k] - expected[k]).norm(), 1e-12);
  }
}

TEST(MovingScan, OccupancyIsCastFromWhereTheLaserWas) {
  // Cells of a metre, 20 m/s ahead: the beams start 2 m behind, at and 2 m ahead of (0.5, 0.5), to the right, ahead and
  // to the left.
  OccupancyBuilder builder({.min_ends = 1}, {.resolution_m = 1.0, .min_range_m = 0.1, .max_range_m = 40.0});
  builder.add(moving_scan({1.0F, 1.0F, 1.0F}, {20.0, 0.0, 0.0}), {0.5, 0.5, 0.0});
  const OccupancyMap map = builder.build();
  ASSERT_EQ(map.geometry.width, 5);
  ASSERT_EQ(map.geometry.height, 3);
  const auto is = [&map](std::int32_t x, std::int32_t y, CellState state) { return map.at({x, y}) == state; };
  EXPECT_TRUE(is(0, 1, CellState::kFree) && is(0, 0, CellState::kOccupied));
  EXPECT_TRUE(is(2, 1, CellState::kFree) && is(3, 1, CellState::kOccupied));
  EXPECT_TRUE(is(4, 1, CellState::kFree) && is(4, 2, CellState::kOccupied));
  EXPECT_TRUE(is(1, 1, CellState::kUnknown));
}

}  // namespace
}  // namespace gdtslam

// Returns as points and points as cells, by hand, at and beside each limit.
#include "gdtslam/mapping/scan_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

LaserScan scan_of_ranges(std::vector<float> ranges_m, double first_bearing_rad = 0.0, double step_rad = 0.0) {
  LaserScan scan;
  scan.first_bearing_rad = first_bearing_rad;
  scan.bearing_step_rad = step_rad;
  scan.ranges_m = std::move(ranges_m);
  return scan;
}

ScanConfig between_ranges(double least_m, double most_m) { return {.min_range_m = least_m, .max_range_m = most_m}; }

std::vector<double> ranges_of(const LaserScan& scan, const ScanConfig& valid) {
  std::vector<double> ranges;
  for (const Point2& point : to_points(scan, valid)) ranges.push_back(point.norm());
  return ranges;
}

TEST(ScanPoints, TheLeastRangeCountsAndTheMostDoesNot) {
  const float below = std::nextafter(0.5F, 0.0F);
  const float under = std::nextafter(10.0F, 0.0F);
  LaserScan scan = scan_of_ranges({below, 0.5F, 2.0F, under, 10.0F, std::numeric_limits<float>::quiet_NaN(),
                                   std::numeric_limits<float>::infinity(), -3.0F});
  EXPECT_EQ(ranges_of(scan, between_ranges(0.5, 10.0)), (std::vector<double>{0.5, 2.0, under}));
  scan.max_range_m = 2.0;  // the sensor's own
  EXPECT_EQ(ranges_of(scan, between_ranges(0.5, 10.0)), (std::vector<double>{0.5}));
}

// 5.6 m, 8.191 m and 4.095 m lie above the nearest float32, 8.1 m and 29.9 m below it: a range that is the limit is one
// without return, whichever side its float fell to, and the next one below is a return.
TEST(ScanPoints, AtALimitThatNoFloatHoldsNothingReturned) {
  for (const double limit_m : {5.6, 8.191, 4.095, 8.1, 29.9, 30.0}) {
    const auto at_limit = static_cast<float>(limit_m);
    const float under = std::nextafter(std::min(at_limit, std::nextafter(at_limit, 0.0F)), 0.0F);
    LaserScan scan = scan_of_ranges({at_limit, under});
    EXPECT_EQ(ranges_of(scan, between_ranges(0.1, limit_m)), (std::vector<double>{under})) << limit_m << " asked for";
    scan.max_range_m = limit_m;
    EXPECT_EQ(ranges_of(scan, between_ranges(0.1, 80.0)), (std::vector<double>{under})) << limit_m << " of the sensor";
    EXPECT_TRUE(scan.is_at_limit(static_cast<double>(at_limit)));
    EXPECT_FALSE(scan.is_at_limit(static_cast<double>(under)));
  }
}

TEST(ScanPoints, AreSeenFromWhereTheLaserStands) {
  LaserScan scan = scan_of_ranges({3.0F, 2.0F}, -0.25 * kPi, 0.5 * kPi);
  scan.T_base_laser = {1.0, 2.0, 0.25 * kPi};
  const std::vector<Point2> points = to_points(scan, between_ranges(0.1, 10.0));
  ASSERT_EQ(points.size(), 2U);
  EXPECT_NEAR(points[0].x(), 4.0, 1e-12);
  EXPECT_NEAR(points[0].y(), 2.0, 1e-12);
  EXPECT_NEAR(points[1].x(), 1.0, 1e-12);
  EXPECT_NEAR(points[1].y(), 4.0, 1e-12);
}

// The directions are kept from scan to scan only while nothing of them changes.
TEST(ScanPoints, EachScanHasItsOwnBearings) {
  ScanPoints kept(between_ranges(0.1, 10.0));
  for (const LaserScan& scan : {scan_of_ranges({1.0F, 2.0F}, 0.1, 0.2), scan_of_ranges({1.0F, 2.0F}, 0.3, 0.2),
                                scan_of_ranges({1.0F, 2.0F}, 0.3, 0.5), scan_of_ranges({1.0F, 2.0F, 3.0F}, 0.3, 0.5),
                                scan_of_ranges({4.0F, 2.0F, 3.0F}, 0.3, 0.5)}) {
    const std::vector<Point2> points = kept.of(scan);
    ASSERT_EQ(points.size(), scan.ranges_m.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double bearing_rad = scan.first_bearing_rad + static_cast<double>(k) * scan.bearing_step_rad;
      EXPECT_NEAR(points[k].x(), static_cast<double>(scan.ranges_m[k]) * std::cos(bearing_rad), 1e-12);
      EXPECT_NEAR(points[k].y(), static_cast<double>(scan.ranges_m[k]) * std::sin(bearing_rad), 1e-12);
    }
  }
}

// A mount 100 km away is wrong, on either axis and side.
TEST(ScanPoints, NoneIsAHundredKilometresAway) {
  const auto count = [](double x_m, double y_m) {
    LaserScan scan = scan_of_ranges({0.5F});
    scan.T_base_laser = {x_m, y_m, 0.0};
    return to_points(scan, between_ranges(0.1, 10.0)).size();
  };
  EXPECT_EQ(count(99999.0, 0.0), 1U);
  EXPECT_EQ(count(99999.5, 0.0), 0U) << "100 km sharp";
  EXPECT_EQ(count(-100001.0, 0.0), 0U);
  EXPECT_EQ(count(0.0, 99999.0), 1U);
  EXPECT_EQ(count(0.0, -100000.0), 0U);
  EXPECT_EQ(count(std::numeric_limits<double>::quiet_NaN(), 0.0), 0U);
}

TEST(InCells, DividesByTheirEdge) {
  const std::vector<PointCells> cells = in_cells({{1.0, -2.0}}, 0.25);
  ASSERT_EQ(cells.size(), 1U);
  EXPECT_EQ(cells[0].x, 4.0F);
  EXPECT_EQ(cells[0].y, -8.0F);
}

TEST(InMap, TurnsAndMoves) {
  const std::vector<Point2> points = in_map({{2.0, 1.0}}, {10.0, 20.0, 0.5 * kPi});
  EXPECT_NEAR(points[0].x(), 9.0, 1e-12);
  EXPECT_NEAR(points[0].y(), 22.0, 1e-12);
}

TEST(MapCells, BeginAtTheirLowerLeftCornerAndEndFarAway) {
  EXPECT_EQ(map_cell_at({0.0, 0.499}, 0.5), (CellIndex{0, 0}));
  EXPECT_EQ(map_cell_at({0.5, -0.001}, 0.5), (CellIndex{1, -1}));
  EXPECT_EQ(map_cell_at({-0.5, -0.501}, 0.5), (CellIndex{-1, -2}));
  EXPECT_EQ(map_cell_at({1.0e12, -1.0e12}, 0.5), (CellIndex{1 << 28, -(1 << 28)}));
}

TEST(WindowOfPoints, HoldsTheirCellsAndTheMargin) {
  EXPECT_TRUE(points_window({}, 0.5, 3).empty());
  const CellBox window = points_window({{0.1, 0.1}, {1.6, -0.6}}, 0.5, 3);
  EXPECT_EQ(window.min, (CellIndex{-3, -5}));
  EXPECT_EQ(window.end, (CellIndex{7, 4}));
}

// Counted from the window's corner; points one after the other in a cell are one.
TEST(KeyframeOfPoints, HasTheirCells) {
  const KeyframeCells keyframe = make_keyframe_cells({{0.1, 0.1}, {0.2, 0.2}, {1.6, -0.6}, {0.3, 0.3}}, 0.5, 3);
  const auto at = [](std::uint32_t x, std::uint32_t y) { return y << 16U | x; };
  EXPECT_EQ(keyframe.window.min, (CellIndex{-3, -5}));
  EXPECT_EQ(keyframe.cells, (std::vector<std::uint32_t>{at(3, 5), at(6, 3), at(3, 5)}));
}

TEST(KeyframeOfPoints, SpansAsManyCellsAsKernelsTake) {
  for (const Point2& way : {Point2(1.0, 0.0), Point2(0.0, 1.0)}) {
    const Point2 first(0.5, 0.5);
    const auto spanning = [&](double cells) {
      return make_keyframe_cells({first, first + (cells - 1.0) * way}, 1.0, 1);
    };
    const CellBox widest = spanning(32765.0).window;
    EXPECT_EQ(std::max(widest.width(), widest.height()), 32767);
    try {
      static_cast<void>(spanning(32766.0));
      ADD_FAILURE() << "one cell too wide";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("32768"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("more than 32767"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace gdtslam

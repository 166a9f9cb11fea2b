// Surfels of surfaces that are known, and what must not become one.
#include "engine/mapping/strokes/surfels.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "gdtslam/core/random.hpp"
#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

constexpr double kCell_m = 0.5;
// The middle of a cell.
const Point3 kMiddle(2.25, -1.75, 1.0);

std::vector<Surfel> surfels_of(const Cloud& cloud) {
  SurfelCollector collector({.cell_m = kCell_m});
  collector.add(cloud);
  return collector.finish();
}

/// A square about the middle of a cell, small enough to lie in it whole.
test::Rectangle square_in_cell(const Point3& normal) {
  const Point3 side = normal.unitOrthogonal();
  const Point3 other = normal.cross(side);
  return {kMiddle - 0.15 * side - 0.15 * other, 0.3 * side, 0.3 * other};
}

TEST(SurfelCollector, APlaneInACellIsOneSurfelWithItsNormalAndMean) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Point3 normal = Point3(random.normal(), random.normal(), random.normal()).normalized();
    Cloud cloud;
    test::strew(cloud, square_in_cell(normal), 400, 0.005, random);
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      cloud[k].scan = static_cast<std::uint32_t>(7 + k / 100);  // scans 7 to 10
      cloud[k].elevation_rad = 0.1F + 0.01F * static_cast<float>(k / 100);
    }
    const std::vector<Surfel> surfels = surfels_of(cloud);
    ASSERT_EQ(surfels.size(), 1U);
    // Errors of mean and normal of a fit: noise over the square root of the points, over the points' deviation for the
    // normal. Five times these are allowed.
    const double deviation_m = 0.3 / std::sqrt(12.0);
    EXPECT_LT(std::fabs(normal.dot(surfels[0].mean - kMiddle)), 5.0 * 0.005 / 20.0);
    EXPECT_LT((surfels[0].mean - kMiddle).norm(), 5.0 * std::sqrt(2.0) * deviation_m / 20.0);
    EXPECT_LT(surfels[0].normal.cross(normal).norm(), 5.0 * std::sqrt(2.0) * 0.005 / (20.0 * deviation_m));
    EXPECT_NEAR(surfels[0].scan, 8.5, 1.0e-9);
    EXPECT_NEAR(surfels[0].elevation_rad, 0.115, 1.0e-6);
  }
}

TEST(SurfelCollector, ACornerOrABallOrFewPointsAreNone) {
  Random random(2);
  Cloud corner;
  for (const Point3& normal : {Point3(1, 0, 0), Point3(0, 1, 0), Point3(0, 0, 1)}) {
    const Point3 side(normal.y(), normal.z(), normal.x());
    test::strew(corner, {kMiddle, 0.2 * side, 0.2 * normal.cross(side)}, 100, 0.002, random);
  }
  EXPECT_TRUE(surfels_of(corner).empty());
  Cloud ball;
  for (int k = 0; k < 300; ++k) {
    const Point3 off(random.normal(), random.normal(), random.normal());
    ball.push_back(test::cloud_point(kMiddle + 0.2 * off.normalized()));
  }
  EXPECT_TRUE(surfels_of(ball).empty());
  Cloud few;
  test::strew(few, square_in_cell(Point3::UnitX()), 5, 0.001, random);
  EXPECT_TRUE(surfels_of(few).empty());
}

// The points of one scan lie in the scan's own plane, and its normal says nothing about the wall.
TEST(SurfelCollector, OneScanOverAWallIsNone) {
  Random random(3);
  Cloud cloud;
  for (int k = 0; k < 40; ++k) {
    cloud.push_back(test::cloud_point(kMiddle + Point3(random.normal(0.0, 0.01), -0.2 + 0.01 * k, 0.0)));
  }
  EXPECT_TRUE(surfels_of(cloud).empty());
}

// A plane that is seen at all times: each stroke has a surfel of it, a stroke lasts from turn to turn.
TEST(SurfelCollector, AStrokeEndsWhereTheElevationTurns) {
  Random random(4);
  SurfelCollector collector({.cell_m = kCell_m, .most_points = 500});
  const double half_turn_scans = 50.0;
  for (std::uint32_t scan = 0; scan < 275; ++scan) {  // from the middle of a stroke to that of the sixth after it
    Cloud cloud;
    test::strew(cloud, square_in_cell(Point3::UnitZ()), 30, 0.002, random);
    for (CloudPoint& point : cloud) {
      point.scan = scan;
      // Trembles by less than what counts as a turn.
      point.elevation_rad =
          static_cast<float>(0.5 * std::sin(3.14159265 * scan / half_turn_scans) + (scan % 2 == 0 ? 0.01 : -0.01));
    }
    collector.add(cloud);
  }
  const std::vector<Surfel> surfels = collector.finish();
  ASSERT_EQ(surfels.size(), 6U);
  const std::array<double, 6> middles{12.5, 50.0, 100.0, 150.0, 200.0, 250.0};
  for (std::uint32_t k = 0; k < 6; ++k) {
    EXPECT_EQ(surfels[k].stroke, k);
    EXPECT_NEAR(surfels[k].scan, middles[k], 8.0);  // the end of a stroke is seen some scans late
  }
}

}  // namespace
}  // namespace gdtslam

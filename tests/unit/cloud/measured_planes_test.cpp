// What planes are, how large, and in which order: of rectangles whose area and extent are known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/cloud/measured_plane.hpp"
#include "gdtslam/core/angle.hpp"
#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

using test::Rectangle;
using test::strew;

constexpr double kGap_m = 0.25;

std::vector<MeasuredPlane> planes_of(const Cloud& cloud, std::uint32_t most = 32) {
  PlaneSearch search;
  search.gap_m = kGap_m;
  search.max_planes = most;
  return measured_planes(cloud, find_planes(cloud, search), kGap_m);
}

Cloud cloud_of(const std::vector<Rectangle>& rectangles, double points_per_m2, double noise_m = 0.005) {
  Random random(11);
  Cloud cloud;
  for (const Rectangle& rectangle : rectangles) {
    const double area_m2 = rectangle.side.norm() * rectangle.other.norm();
    strew(cloud, rectangle, static_cast<std::size_t>(points_per_m2 * area_m2), noise_m, random);
  }
  return cloud;
}

std::vector<PlaneKind> kinds_of(const std::vector<MeasuredPlane>& planes) {
  std::vector<PlaneKind> kinds;
  for (const MeasuredPlane& plane : planes) kinds.push_back(plane.kind);
  return kinds;
}

// A room of 6 x 4 x 2.5 m: two of 24, two of 15 and two of 10 square metres.
TEST(MeasuredPlanes, ARoomIsAFloorACeilingAndFourWallsByArea) {
  const std::vector<MeasuredPlane> planes = planes_of(cloud_of(test::room({6.0, 4.0, 2.5}), 1000.0), 6);
  ASSERT_EQ(planes.size(), 6U);
  const double areas_m2[] = {24.0, 24.0, 15.0, 15.0, 10.0, 10.0};
  const double lengths_m[] = {6.0, 6.0, 6.0, 6.0, 4.0, 4.0};
  const double widths_m[] = {4.0, 4.0, 2.5, 2.5, 2.5, 2.5};
  for (std::size_t k = 0; k < planes.size(); ++k) {
    // Along an edge the points within 3 cm belong to the larger plane.
    EXPECT_LE(planes[k].area_m2, 1.02 * areas_m2[k]) << k;
    EXPECT_GE(planes[k].area_m2, 0.98 * (lengths_m[k] - 0.06) * (widths_m[k] - 0.06)) << k;
    EXPECT_NEAR(planes[k].extent_m[0], lengths_m[k], 0.07) << k;
    EXPECT_NEAR(planes[k].extent_m[1], widths_m[k], 0.07) << k;
    EXPECT_TRUE(k == 0 || planes[k - 1].area_m2 >= planes[k].area_m2) << k;
    const Plane& plane = planes[k].patch.plane;
    EXPECT_TRUE(planes[k].kind == PlaneKind::kWall ? plane.offset_m >= 0.0 : plane.normal.z() > 0.99) << k;
  }
  EXPECT_THAT(kinds_of(planes), testing::UnorderedElementsAre(PlaneKind::kFloor, PlaneKind::kCeiling, PlaneKind::kWall,
                                                              PlaneKind::kWall, PlaneKind::kWall, PlaneKind::kWall));
  for (const MeasuredPlane& plane : planes) {
    if (plane.kind == PlaneKind::kFloor) {
      EXPECT_NEAR(plane.patch.centre.z(), 0.0, 0.01);
    }
    if (plane.kind == PlaneKind::kCeiling) {
      EXPECT_NEAR(plane.patch.centre.z(), 2.5, 0.01);
    }
  }
}

// A table is level and neither, and a ramp of 20 deg is no floor.
TEST(MeasuredPlanes, ATableIsLevelAndARampSlopes) {
  std::vector<Rectangle> scene = test::room({6.0, 4.0, 2.5});
  scene.push_back({{2.0, 1.0, 0.8}, {1.6, 0.0, 0.0}, {0.0, 0.8, 0.0}});
  const double up_m = std::tan(rad_from_deg(20.0));
  scene.push_back({{0.5, 2.5, 0.5}, {1.0, 0.0, up_m}, {0.0, 1.0, 0.0}});
  const std::vector<MeasuredPlane> planes = planes_of(cloud_of(scene, 1000.0), 8);
  ASSERT_EQ(planes.size(), 8U);
  const std::vector<PlaneKind> kinds = kinds_of(planes);
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), PlaneKind::kLevel), 1);
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), PlaneKind::kSlope), 1);
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), PlaneKind::kFloor), 1);
  for (const MeasuredPlane& plane : planes) {
    if (plane.kind == PlaneKind::kLevel) {
      EXPECT_NEAR(plane.extent_m[0], 1.6, 0.05);
      EXPECT_NEAR(plane.extent_m[1], 0.8, 0.05);
    }
    if (plane.kind == PlaneKind::kSlope) {  // along the level, and up the ramp
      EXPECT_NEAR(plane.extent_m[0], 1.0, 0.05);
      EXPECT_NEAR(plane.extent_m[1], 1.0 / std::cos(rad_from_deg(20.0)), 0.05);
    }
  }
}

// However a floor lies about the upright axis, its sides are those of its rectangle.
TEST(MeasuredPlanes, TheExtentOfAFloorDoesNotDependOnItsHeading) {
  for (const double heading_deg : {0.0, 12.34, 45.0, 77.7, 133.0}) {
    const double heading_rad = rad_from_deg(heading_deg);
    const Point3 along(std::cos(heading_rad), std::sin(heading_rad), 0.0);
    const Point3 across(-along.y(), along.x(), 0.0);
    const std::vector<MeasuredPlane> planes =
        planes_of(cloud_of({{Point3(20.0, -3.0, 0.0), 5.0 * along, 3.0 * across}}, 2000.0));
    ASSERT_EQ(planes.size(), 1U);
    EXPECT_EQ(planes[0].kind, PlaneKind::kFloor);
    EXPECT_NEAR(planes[0].extent_m[0], 5.0, 0.02) << heading_deg;
    EXPECT_NEAR(planes[0].extent_m[1], 3.0, 0.02) << heading_deg;
    EXPECT_NEAR(planes[0].area_m2, 15.0, 0.3) << heading_deg;
  }
}

// What was not seen is not counted: the area of an L is that of its arms, and a pillar's foot is missing; a gap that is
// narrower than points may be apart is.
TEST(MeasuredPlanes, TheAreaIsWhatWasSeen) {
  const std::vector<Rectangle> l{{{0, 0, 0}, {4, 0, 0}, {0, 1, 0}}, {{0, 1, 0}, {1, 0, 0}, {0, 3, 0}}};
  const std::vector<MeasuredPlane> planes = planes_of(cloud_of(l, 2000.0));
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_NEAR(planes[0].area_m2, 7.0, 0.15);
  Cloud pierced = cloud_of({{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}}, 2000.0);
  std::erase_if(pierced, [](const CloudPoint& p) {
    const bool is_pillar = std::fabs(p.x_m - 2.0F) < 0.5F && std::fabs(p.y_m - 2.0F) < 0.5F;
    const bool is_crack = std::fabs(p.x_m - 3.0F) < 0.05F;
    return is_pillar || is_crack;
  });
  const std::vector<MeasuredPlane> with_hole = planes_of(pierced);
  ASSERT_EQ(with_hole.size(), 1U);
  EXPECT_NEAR(with_hole[0].area_m2, 15.0, 0.3);
}

// As many points on the small one: area counts, not density.
TEST(MeasuredPlanes, TheLargestAreaComesFirstHoweverSparseItIs) {
  Random random(4);
  Cloud cloud;
  strew(cloud, {{0, 0, 0}, {0.5, 0, 0}, {0, 0, 0.5}}, 20'000, 0.005, random);
  strew(cloud, {{0, 3, 0}, {3, 0, 0}, {0, 0, 3}}, 5'000, 0.005, random);
  const std::vector<MeasuredPlane> planes = planes_of(cloud);
  ASSERT_EQ(planes.size(), 2U);
  EXPECT_NEAR(planes[0].area_m2, 9.0, 0.3);
  EXPECT_NEAR(planes[1].area_m2, 0.25, 0.02);
}

TEST(MeasuredPlanes, OfNothingIsNothing) { EXPECT_TRUE(measured_planes({}, {}, kGap_m).empty()); }

// Points on a lattice whose nodes are those of the grid: exact. One row of points has no area.
TEST(AreaOfPoints, IsExactOnALattice) {
  std::vector<PlanePoint> points;
  for (int x = 0; x <= 20; ++x) {
    for (int y = 0; y <= 10; ++y) points.push_back({0.1 * x, 0.1 * y});
  }
  EXPECT_NEAR(area_of_points_m2(points, 0.8), 2.0, 1e-9);
  points.clear();
  for (int x = 0; x <= 20; ++x) points.push_back({0.1 * x, 3.0});
  EXPECT_EQ(area_of_points_m2(points, 0.8), 0.0);
}

}  // namespace
}  // namespace gdtslam

// Walls between the returns of scans of walls that are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/mapping/surface/surface_points.hpp"
#include "engine/mapping/wheels/known_surfaces.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

constexpr double kSpacing_m = 0.025;

std::vector<Point2> seen(const std::vector<test::Segment>& walls, const Pose2& T_map_base, int beams) {
  return to_points(test::scan_of(walls, T_map_base, 0.0, beams), {});
}

double widest_gap_m(std::vector<double> along) {
  std::sort(along.begin(), along.end());
  double widest = 0.0;
  for (std::size_t i = 1; i < along.size(); ++i) widest = std::max(widest, along[i] - along[i - 1]);
  return widest;
}

std::vector<double> along_of(const std::vector<Point2>& points, double least, double most) {
  std::vector<double> along;
  for (const Point2& p : points) {
    if (p.y() > 0.0 && p.x() > least && p.x() < most) along.push_back(p.x());
  }
  return along;
}

TEST(ClosedSurfaces, AWallAtAGrazingAngleHasNoGaps) {
  const std::vector<test::Segment> corridor{{{-50.0, 1.2}, {50.0, 1.2}}, {{-50.0, -1.2}, {50.0, -1.2}}};
  const std::vector<Point2> points = seen(corridor, {}, 180);
  const std::vector<Point2> closed = with_surfaces_closed(points, kSpacing_m);
  ASSERT_GE(along_of(points, 0.0, 5.0).size(), 4U);
  EXPECT_GT(widest_gap_m(along_of(points, 0.0, 5.0)), 0.2) << "what the beams leave open";
  EXPECT_LE(widest_gap_m(along_of(closed, 0.0, 5.0)), kSpacing_m + 1.0e-9);
  for (const Point2& p : closed) EXPECT_NEAR(std::fabs(p.y()), 1.2, 1.0e-3) << "a point on no wall";
  EXPECT_TRUE(std::equal(points.begin(), points.end(), closed.begin())) << "the returns themselves come first";
}

TEST(ClosedSurfaces, AnOpeningStaysOpen) {
  const std::vector<test::Segment> walls{
      {{-50.0, 1.2}, {2.0, 1.2}}, {{3.0, 1.2}, {50.0, 1.2}}, {{1.0, 3.0}, {6.0, 3.0}}};
  for (const Point2& p : with_surfaces_closed(seen(walls, {}, 720), kSpacing_m)) {
    EXPECT_FALSE(p.x() > 2.05 && p.x() < 2.95 && p.y() < 1.5) << p.x() << ", " << p.y();
  }
}

// Pillars in a row, and beams between them that met nothing.
TEST(ClosedSurfaces, PillarsAreNoWall) {
  std::vector<Point2> points;
  for (int k = -8; k <= 8; ++k) {
    const Point2 pillar{static_cast<double>(k), 3.0};
    for (int beam = -1; beam <= 1; ++beam) {
      const double angle = std::atan2(pillar.y(), pillar.x()) + 0.005 * beam;
      points.emplace_back(pillar.norm() * std::cos(angle), pillar.norm() * std::sin(angle));
    }
  }
  std::sort(points.begin(), points.end(),
            [](const Point2& a, const Point2& b) { return std::atan2(a.y(), a.x()) < std::atan2(b.y(), b.x()); });
  EXPECT_EQ(with_surfaces_closed(points, 0.3).size(), points.size());
}

TEST(ClosedSurfaces, FewPointsStayAsTheyAre) {
  const std::vector<Point2> points{{1.0, 1.0}, {1.0, 1.4}, {1.0, 1.8}};
  EXPECT_EQ(with_surfaces_closed(points, kSpacing_m).size(), 3U);
  EXPECT_TRUE(with_surfaces_closed({}, kSpacing_m).empty());
  const std::vector<Point2> origin(8, Point2{0.0, 0.0});
  EXPECT_EQ(with_surfaces_closed(origin, kSpacing_m).size(), origin.size());
}

// A wall 1 m aside, its far returns ever farther apart, and something beside it.
TEST(LoneOnWall, OnlyReturnsFarFromTheirNeighboursOnALineWithThem) {
  const std::vector<Point2> points{{1.0, -1.0}, {1.3, -1.0}, {2.0, -1.0}, {3.0, -1.0}, {5.0, -1.0}, {4.0, 1.0}};
  EXPECT_FALSE(lone_on_wall(points, 0));
  EXPECT_FALSE(lone_on_wall(points, 1)) << "0.3 m from its neighbour";
  for (const std::size_t far : {2U, 3U, 4U}) {
    const std::optional<Point2> along = lone_on_wall(points, far);
    ASSERT_TRUE(along) << far;
    EXPECT_NEAR(along->x(), 1.0, 1e-12);
    EXPECT_NEAR(along->y(), 0.0, 1e-12);
  }
  EXPECT_FALSE(lone_on_wall(points, 5)) << "on no line";
  EXPECT_FALSE(lone_on_wall({points.data(), 1}, 0));
}

// Of the same returns, 10 m farther on, those that lie where the map knows the wall half a metre to both sides stay.
TEST(KnownSurfaces, LoneReturnsBeyondTheKnownEndOfAWallWait) {
  const std::vector<Point2> points{{1.0, -1.0}, {1.3, -1.0}, {2.0, -1.0}, {3.0, -1.0}, {5.0, -1.0}, {4.0, 1.0}};
  const Pose2 T_map_base{10.0, 0.0, 0.0};
  KnownSurfaces known;
  EXPECT_EQ(known.without_wall_ends(points, T_map_base).size(), 3U) << "of an empty map no lone return";
  std::vector<Point2> wall;
  for (double x = 9.0; x < 12.8; x += 0.1) wall.emplace_back(x, -1.0);
  known.add(wall, {});
  const std::vector<Point2> kept = known.without_wall_ends(points, T_map_base);
  ASSERT_EQ(kept.size(), 4U);
  EXPECT_EQ(kept[2], points[2]);
  EXPECT_EQ(kept[3], points[5]);
}

}  // namespace
}  // namespace gdtslam

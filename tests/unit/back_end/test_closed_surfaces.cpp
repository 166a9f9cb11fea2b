// Walls between the returns of scans of walls that are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/mapping/surface/closed_surfaces.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

constexpr double kSpacing_m = 0.025;

std::vector<Point2> seen(const std::vector<test::Segment>& walls, const Pose2& T_map_base, int beams) {
  return points_of(test::scan_of(walls, T_map_base, 0.0, beams), {});
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

}  // namespace
}  // namespace gdtslam

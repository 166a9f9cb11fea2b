// Normals and shapes of scans of walls that are known.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

std::vector<Point2> seen(const std::vector<test::Segment>& walls, const Pose2& T_map_base) {
  return to_points(test::scan_of(walls, T_map_base, 0.0, 720), {});
}

/// Two walls along x, 2 m apart, far longer than the laser reaches.
std::vector<test::Segment> corridor() { return {{{-500.0, 1.0}, {500.0, 1.0}}, {{-500.0, -1.0}, {500.0, -1.0}}}; }

TEST(KeptScan, NormalsStandOnTheWallTowardTheRobot) {
  for (const double heading : {0.0, 0.4, -1.1}) {
    const Pose2 T{0.3, 0.2, heading};
    const KeptScan kept = keep_scan(seen(corridor(), T));
    ASSERT_GT(kept.surface.size(), 300U);
    for (const SurfacePoint& p : kept.surface) {
      const double y = (T * p.point()).y();
      const Point2 normal = T * p.normal() - T.translation();
      EXPECT_NEAR(normal.x(), 0.0, 1e-4);
      EXPECT_NEAR(normal.y(), y > 0.0 ? -1.0 : 1.0, 1e-4);
    }
  }
}

TEST(KeptScan, KeepsEveryReturnOnceAndSortsSurfacesByBearing) {
  const std::vector<Point2> points = seen(test::furnished_room(), {1.0, 0.3, 0.7});
  const KeptScan kept = keep_scan(points);
  EXPECT_EQ(kept.points(), points.size());
  EXPECT_EQ(kept.bytes(), kept.surface.size() * 20 + kept.lone.size() * 8);
  for (std::size_t i = 1; i < kept.surface.size(); ++i) {
    EXPECT_LE(kept.surface[i - 1].direction, kept.surface[i].direction);
  }
  double sum = 0.0;
  for (const Point2& p : points) sum += p.x() + 3.0 * p.y();
  double kept_sum = 0.0;
  for (const SurfacePoint& p : kept.surface) kept_sum += p.point().x() + 3.0 * p.point().y();
  for (const LonePoint& p : kept.lone) kept_sum += p.point().x() + 3.0 * p.point().y();
  EXPECT_NEAR(kept_sum, sum, 1e-3);
}

// At 5 m beams two degrees apart meet a wall 0.17 m apart and more.
TEST(KeptScan, SparseBeamsFindTheirSurfaces) {
  std::vector<Point2> wall;
  for (int k = -12; k <= 12; ++k) {
    const double bearing = rad_from_deg(2.0 * k);
    wall.emplace_back(5.0, 5.0 * std::tan(bearing));
  }
  const KeptScan kept = keep_scan(wall);
  EXPECT_GE(kept.surface.size(), 23U);
  for (const SurfacePoint& p : kept.surface) EXPECT_NEAR(p.normal_x, -1.0, 1e-6);
}

TEST(KeptScan, PointsWithoutNeighboursHaveNoSurface) {
  std::vector<Point2> poles;
  for (int k = 0; k < 20; ++k) poles.emplace_back(std::cos(0.15 * k) * 5.0, std::sin(0.15 * k) * 5.0);  // 0.75 m
  const KeptScan kept = keep_scan(poles);
  EXPECT_TRUE(kept.surface.empty());
  EXPECT_EQ(kept.lone.size(), poles.size());
  EXPECT_TRUE(keep_scan({}).surface.empty());
}

TEST(ScanShape, SaysWhatACorridorCannotTell) {
  const KeptScan kept = keep_scan(seen(corridor(), {0.0, 0.0, 0.0}));
  const Matrix3 shape = surface_shape(kept);
  const auto n = static_cast<double>(kept.surface.size());
  EXPECT_NEAR(shape(0, 0) / n, 0.0, 1e-6);  // along
  EXPECT_NEAR(shape(1, 1) / n, 1.0, 1e-6);  // across
  EXPECT_GT(shape(2, 2) / n, 0.5);
  const Matrix3 one = shape_of_one(shape, kept.surface.size(), 1e-6, 3e-3).shape;
  EXPECT_NEAR(one(0, 0), 1e-6, 1e-8);
  EXPECT_NEAR(one(1, 1), 1.0, 0.01);
}

TEST(ScanShape, OfARoundRoomSaysNothingOfTheHeading) {
  std::vector<Point2> circle;
  for (int k = 0; k < 720; ++k) {
    const double bearing = -kPi + kTwoPi * k / 720.0;
    circle.emplace_back(3.0 * std::cos(bearing), 3.0 * std::sin(bearing));
  }
  const KeptScan kept = keep_scan(circle);
  const Matrix3 one = shape_of_one(surface_shape(kept), kept.surface.size(), 1e-6, 3e-3).shape;
  EXPECT_NEAR(one(0, 0), 0.5, 0.01);
  EXPECT_NEAR(one(1, 1), 0.5, 0.01);
  EXPECT_LT(one(2, 2), 1e-3);
}

TEST(EigenOfSymmetric, GivesTheMatrixBack) {
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    Matrix3 a;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) a(i, j) = a(j, i) = random.normal(0.0, round % 2 == 0 ? 1.0 : 1e3);
    }
    const Eigen3 eigen = eigen_of_symmetric(a);
    const Matrix3 back = with_eigenvalues(eigen, [](double value) { return value; });
    const Matrix3 unit = transposed_times(eigen.vectors, eigen.vectors);
    const double size = std::fabs(eigen.values[0]) + std::fabs(eigen.values[1]) + std::fabs(eigen.values[2]);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(back(i, j), a(i, j), 1e-13 * size);
        EXPECT_NEAR(unit(i, j), i == j ? 1.0 : 0.0, 1e-14);
      }
    }
  }
}

// Of a bare corridor nothing tells how far along it the robot is, and everything how far across.
TEST(KnowsWay, WhereWallsStandAcrossIt) {
  const KeptScan bare = keep_scan(seen(corridor(), {0.0, 0.2, 0.4}));
  const Pose2 heading{0.0, 0.0, -0.4};  // of the world's axes in the robot's frame
  EXPECT_FALSE(knows_way(bare, heading * Point2{1.0, 0.0}));
  EXPECT_FALSE(knows_way(bare, heading * Point2{-0.01, 0.0})) << "the same, backwards and a little";
  EXPECT_TRUE(knows_way(bare, heading * Point2{0.0, 0.5}));
  const KeptScan room = keep_scan(seen(test::furnished_room(), {1.0, 0.3, 0.7}));
  for (const double angle : {0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0}) {
    EXPECT_TRUE(knows_way(room, {std::cos(angle), std::sin(angle)})) << angle;
  }
  EXPECT_FALSE(knows_way({}, {1.0, 0.0})) << "nothing was seen";
}

// Half the second difference of the squared ways, in half metres, that the returns go when the pose moves.
TEST(LoneInformation, IsTheCurvatureOfWhereTheReturnsLie) {
  const std::vector<Point2> returns{{15.0, 9.0}, {14.0, 10.0}, {-2.0, -17.0}, {-4.0, -16.0}};  // a metre apart and more
  const KeptScan kept = keep_scan(returns);
  ASSERT_TRUE(kept.surface.empty());
  const Matrix3 information = lone_information(kept);
  const auto squared_ways = [&returns](const Eigen::Vector3d& v) {
    double sum = 0.0;
    for (const Point2& p : returns) sum += (exp_se2(v) * p - p).squaredNorm() / (0.5 * 0.5);
    return sum;
  };
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d a = kStep * Eigen::Vector3d::Unit(i);
      const Eigen::Vector3d b = kStep * Eigen::Vector3d::Unit(j);
      const double mixed = (squared_ways(a + b) - squared_ways(a - b)) / (4.0 * kStep * kStep);
      EXPECT_NEAR(information(i, j), i == j ? squared_ways(a) / (kStep * kStep) : mixed, 0.05) << i << ' ' << j;
    }
  }
}

// Between the walls of a corridor a post returns one beam, which says within a decimetre where it is.
TEST(LoneInformation, WhereSurfacesTellOnlyCornersCount) {
  const auto corridor_with = [](const std::vector<Point2>& between) {
    std::vector<Point2> points;
    for (int k = 0; k <= 30; ++k) points.emplace_back(0.1 * k, -1.0);
    points.insert(points.end(), between.begin(), between.end());
    for (int k = 30; k >= 0; --k) points.emplace_back(0.1 * k, 1.0);
    return keep_scan(points);
  };
  EXPECT_EQ(lone_information(corridor_with({})), Matrix3{});
  const Matrix3 post = lone_information(corridor_with({{3.5, 0.2}}));
  EXPECT_NEAR(post(0, 0), 1.0 / (0.1 * 0.1), 1e-6);
  EXPECT_NEAR(post(1, 1), 1.0 / (0.1 * 0.1), 1e-6);
  EXPECT_NEAR(post(0, 2), -0.2 / (0.1 * 0.1), 1e-4);
  EXPECT_NEAR(post(1, 2), 3.5 / (0.1 * 0.1), 1e-4);
  EXPECT_EQ(lone_information(corridor_with({{4.0, -1.0}, {5.0, -1.0}})), Matrix3{}) << "lone ones on a wall";
  EXPECT_EQ(lone_information({}), Matrix3{});
}

}  // namespace
}  // namespace gdtslam

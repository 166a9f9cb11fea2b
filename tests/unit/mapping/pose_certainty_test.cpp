// How sure a match is, by hand: a wall that is known to the cell, in whose normal the scan says all and along which
// nothing.
#include "engine/mapping/match/pose_certainty.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "engine/mapping/cost/objective.hpp"
#include "engine/mapping/map/local_field.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr double kPoseCell_m = 0.05;
constexpr std::uint32_t kPoseRadius = 10;  // cells: half a metre
constexpr double kRounding = kPoseCell_m * kPoseCell_m / 12.0;
constexpr double kGate_m = 0.12;

class KnownWall : public testing::Test {
 protected:
  /// The centre of a cell of the map.
  static Point2 centre(int x, int y) { return {(x + 0.5) * kPoseCell_m, (y + 0.5) * kPoseCell_m}; }
  /// Cells of the wall: columns first to last, 60 rows.
  void build(int first, int last) {
    std::vector<Point2> points;
    for (int x = first; x <= last; ++x) {
      for (int y = -30; y < 30; ++y) points.push_back(centre(x, y));
    }
    const KeyframeCells keyframe = make_keyframe_cells(points, kPoseCell_m, kPoseRadius);
    map_.grow_to_hold(keyframe.window);
    local_.prepare(keyframe, map_);
    local_.merge_into(map_, {.rule = MergeRule::kWorking, .threshold = 256, .lift = 0});
  }
  /// As the robot sees points of the map.
  static std::vector<PointCells> seen(const std::vector<Point2>& points, const Pose2& T_map_base) {
    std::vector<Point2> there;
    for (const Point2& point : points) there.push_back(inverse(T_map_base) * point);
    return in_cells(there, kPoseCell_m);
  }
  /// The sum over points of J^T J, J = (n, p x n), the normal along the map's x.
  static Matrix3 information(const std::vector<PointCells>& points, double theta_rad) {
    Matrix3 sum;
    const Point2 n(std::cos(theta_rad), -std::sin(theta_rad));
    for (const PointCells& point : points) {
      const Point2 p(kPoseCell_m * static_cast<double>(point.x), kPoseCell_m * static_cast<double>(point.y));
      const Tangent2 J{n.x(), n.y(), p.x() * n.y() - p.y() * n.x()};
      sum += outer(J, J);
    }
    return sum;
  }
  static void expect_as(const Matrix3& expected, const std::optional<Matrix3>& found) {
    ASSERT_TRUE(found);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        EXPECT_NEAR((*found)(row, column), expected(row, column), 1e-5 * std::fabs(expected(row, column)) + 1e-9)
            << row << " " << column;
      }
    }
  }
  static Matrix3 with_rounding(const Matrix3& covariance, const std::vector<PointCells>& points) {
    double sq_range = 0.0;
    for (const PointCells& p : points)
      sq_range += kPoseCell_m * kPoseCell_m * static_cast<double>(p.x * p.x + p.y * p.y);
    const double lever = sq_range / static_cast<double>(points.size());
    return covariance + Matrix3::diagonal(kRounding, kRounding, kRounding / lever);
  }

  std::unique_ptr<Backend> backend_ = make_cpu_backend({});
  GlobalField map_{*backend_, kPoseCell_m, kPoseRadius, 1U << 24U};
  LocalField local_{*backend_, kPoseRadius};
};

const Matrix3 kLeast = Matrix3::diagonal(0.01, 0.01, 0.01);

TEST_F(KnownWall, SaysAllAcrossAndNothingAlong) {
  build(0, 0);
  std::vector<Point2> wall;
  for (int y = -12; y < 12; ++y) wall.push_back(centre(0, y));
  for (const double theta_rad : {0.0, 0.6, -2.0}) {
    const Pose2 at{-1.0, 0.2, theta_rad};
    const std::vector<PointCells> points = seen(wall, at);
    const Matrix3 expected = inverse(1.0 / kRounding * information(points, theta_rad) + kLeast);
    expect_as(with_rounding(expected, points), covariance_by_scan(map_, points, at, kGate_m));
  }
  const std::vector<PointCells> ahead = seen(wall, {-1.0, 0.0, 0.0});
  const std::optional<Matrix3> facing = covariance_by_scan(map_, ahead, {-1.0, 0.0, 0.0}, kGate_m);
  ASSERT_TRUE(facing);
  EXPECT_LT((*facing)(0, 0), 1.1 * kRounding);
  EXPECT_NEAR((*facing)(1, 1), 100.0, 1.0) << "ten metres";
}

// Points of one cell share its error.
TEST_F(KnownWall, PointsOfACellCountOnce) {
  build(0, 0);
  std::vector<Point2> wall;
  std::vector<Point2> doubled;
  for (int y = -12; y < 12; ++y) {
    wall.push_back(centre(0, y));
    doubled.insert(doubled.end(), {centre(0, y), centre(0, y), centre(0, y)});
  }
  const Pose2 at{-1.0, 0.2, 0.3};
  const std::optional<Matrix3> once = covariance_by_scan(map_, seen(wall, at), at, kGate_m);
  ASSERT_TRUE(once);
  expect_as(*once, covariance_by_scan(map_, seen(doubled, at), at, kGate_m));
}

// A cell off the variance is that of the distances, and of rounding on top.
TEST_F(KnownWall, DistancesWithinTheGateAreItsNoise) {
  build(0, 0);
  std::vector<Point2> beside;
  for (int y = -12; y < 12; ++y) beside.push_back(centre(1, y));
  const Pose2 at{-1.0, 0.2, 0.0};
  const std::vector<PointCells> points = seen(beside, at);
  const double variance = kPoseCell_m * kPoseCell_m + kRounding;
  const Matrix3 expected = inverse(1.0 / variance * information(points, 0.0) + kLeast);
  expect_as(with_rounding(expected, points), covariance_by_scan(map_, points, at, kPoseCell_m));
  EXPECT_FALSE(covariance_by_scan(map_, points, at, 0.99 * kPoseCell_m)) << "beyond the gate";
  EXPECT_FALSE(covariance_by_scan(map_, {}, at, kGate_m));
}

// In what is filled two cells from its face half of the slope is left, and farther in none.
TEST_F(KnownWall, InsideOfSomethingThickNothingIsSaid) {
  build(-20, 0);
  const Pose2 at{-3.0, 0.2, 0.0};
  const auto of_column = [&](int x) {
    return covariance_by_scan(map_, seen({centre(x, -3), centre(x, 3)}, at), at, kGate_m);
  };
  EXPECT_TRUE(of_column(-2));
  EXPECT_FALSE(of_column(-3));
}

/// Points so far beside the wall.
std::vector<PointCells> so_far(double away_m) {
  std::vector<Point2> points;
  for (int y = -12; y < 12; ++y) points.emplace_back(0.5 * kPoseCell_m + away_m, (y + 0.5) * kPoseCell_m);
  return in_cells(points, kPoseCell_m);
}

TEST_F(KnownWall, AScanFitsAboutAsWellWithinThreeTenthsAndThreeMillimetres) {
  build(0, 0);
  const auto fits = [&](double matched_m, double there_m) {
    return fits_about_as_well(map_, so_far(0.0), {there_m, 0.0, 0.0}, {matched_m, 0.0, 0.0});
  };
  EXPECT_TRUE(fits(0.0, 0.0025));
  EXPECT_FALSE(fits(0.0, 0.0035));
  EXPECT_TRUE(fits(0.1, 0.132));
  EXPECT_FALSE(fits(0.1, 0.134));
  EXPECT_TRUE(fits(0.2, 0.262));
  EXPECT_FALSE(fits(0.2, 0.264));
  // What is farther than 0.3 m counts as that.
  EXPECT_FALSE(fits(0.22, 0.4));
  EXPECT_TRUE(fits(0.24, 0.4));
}

TEST_F(KnownWall, MeanDistancesAreThoseOfThePointsUpToTheFarthest) {
  build(0, 0);
  std::vector<PointCells> points = so_far(0.1);
  const std::vector<PointCells> far = so_far(0.45);
  points.insert(points.end(), far.begin(), far.end());
  const auto [there, here] = mean_distances_m(map_, points, {Pose2{}, Pose2{-0.05, 0.0, 0.0}}, 0.3);
  EXPECT_NEAR(there, 0.2, 0.0005);
  EXPECT_NEAR(here, 0.175, 0.0005);
  EXPECT_EQ(mean_distances_m(map_, {}, {Pose2{}, Pose2{}}, 0.3)[0], 0.0);
}

TEST_F(KnownWall, WeighingTakesWhatTheScanShowsAndLeavesTheRest) {
  build(0, 0);
  std::vector<Point2> wall;
  for (int y = -12; y < 12; ++y) wall.push_back(centre(0, y));
  const Pose2 at{-1.0, 0.0, 0.0};
  PoseCertainty certainty(Matrix3::diagonal(1.0, 4.0, 0.04));
  certainty.weigh(map_, seen({{-2.0, 0.0}}, at), at, kGate_m);
  EXPECT_EQ(certainty.covariance(), Matrix3::diagonal(1.0, 4.0, 0.04)) << "no point is near the wall";
  certainty.weigh(map_, seen(wall, at), at, kGate_m);
  EXPECT_LT(certainty.covariance()(0, 0), 0.001);
  // Across and about the scan tells all, so that of s^2 (0.25 - 0.24 s) the best eighth counts, 6/8.
  EXPECT_NEAR(certainty.covariance()(1, 1), 1.0 / 0.07, 0.01);
}

// Of informations mixed by eighths the one with the largest determinant.
TEST(CovarianceIntersection, HasTheSmallestDeterminant) {
  const auto expect_diagonal = [](const Matrix3& found, double a, double b, double c) {
    EXPECT_NEAR(found(0, 0), a, 1e-12);
    EXPECT_NEAR(found(1, 1), b, 1e-12);
    EXPECT_NEAR(found(2, 2), c, 1e-12);
  };
  expect_diagonal(intersect_covariances(Matrix3::diagonal(1.0, 4.0, 1.0), Matrix3::diagonal(4.0, 1.0, 1.0)), 1.6, 1.6,
                  1.0);
  // Of (0.2 + 0.8 s) (1 - 0.9 s) the best eighth is the third.
  expect_diagonal(intersect_covariances(Matrix3::diagonal(1.0, 10.0, 1.0), Matrix3::diagonal(5.0, 1.0, 1.0)), 2.0,
                  1.0 / 0.6625, 1.0);
  const Matrix3 sure = Matrix3::diagonal(1.0, 1.0, 1.0);
  const Matrix3 unsure = Matrix3::diagonal(4.0, 4.0, 4.0);
  expect_diagonal(intersect_covariances(sure, unsure), 1.0, 1.0, 1.0);
  expect_diagonal(intersect_covariances(unsure, sure), 1.0, 1.0, 1.0);
}

// A metre on a heading that is off moves the robot aside.
TEST(PoseCertainty, IsCarriedAlongTheWayWithWhatTheWheelsMiss) {
  PoseCertainty certainty(Matrix3::diagonal(0.01, 0.02, 0.04));
  const Prediction by_wheels{.T_map_base = Pose2{1.0, 0.0, 0.0} * Pose2{2.0, 0.0, 0.0}, .by_odometry = true};
  certainty.carry({1.0, 0.0, 0.0}, by_wheels, {.sigma_m = 0.1, .sigma_rad = 0.3});
  EXPECT_NEAR(certainty.covariance()(0, 0), 0.01 + 0.01, 1e-12);
  EXPECT_NEAR(certainty.covariance()(1, 1), 0.02 + 4.0 * 0.04 + 0.01, 1e-12);
  EXPECT_NEAR(certainty.covariance()(2, 2), 0.04 + 0.09, 1e-12);
  EXPECT_NEAR(certainty.covariance()(1, 2), 2.0 * 0.04, 1e-12);
  EXPECT_NEAR(certainty.covariance()(0, 2), 0.0, 1e-12);
}

TEST(PoseCertainty, AMotionThatOnlyGoesOnMayBeWrongAltogether) {
  PoseCertainty certainty(Matrix3::diagonal(0.01, 0.02, 0.04));
  certainty.carry({}, {.T_map_base = {}, .travelled_m = 0.5, .turned_rad = 0.2, .by_odometry = false},
                  {.sigma_m = 9.0, .sigma_rad = 9.0});
  EXPECT_NEAR(certainty.covariance()(0, 0), 0.26, 1e-12);
  EXPECT_NEAR(certainty.covariance()(1, 1), 0.27, 1e-12);
  EXPECT_NEAR(certainty.covariance()(2, 2), 0.08, 1e-12);
}

TEST(PoseCertainty, IsThatOfTheOriginToBeginWith) {
  EXPECT_EQ(PoseCertainty().covariance(), Matrix3::diagonal(1.0e-6, 1.0e-6, 1.0e-6));
}

// The robot's axes turned into the map's.
TEST(PoseCertainty, InTheMapIsTurnedWithTheRobot) {
  Matrix3 covariance = Matrix3::diagonal(4.0, 1.0, 0.25);
  covariance(0, 2) = covariance(2, 0) = 0.5;
  const PoseCertainty certainty(covariance);
  const double c = std::cos(kPi / 6.0);
  const double s = 0.5;
  const PoseCovariance in_map = certainty.in_map(kPi / 6.0);
  EXPECT_NEAR(in_map.xx, 4.0 * c * c + s * s, 1e-12);
  EXPECT_NEAR(in_map.yy, 4.0 * s * s + c * c, 1e-12);
  EXPECT_NEAR(in_map.xy, 3.0 * c * s, 1e-12);
  EXPECT_NEAR(in_map.xt, 0.5 * c, 1e-12);
  EXPECT_NEAR(in_map.yt, 0.5 * s, 1e-12);
  EXPECT_NEAR(in_map.tt, 0.25, 1e-12);
}

}  // namespace
}  // namespace gdtslam

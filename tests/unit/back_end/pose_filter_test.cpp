// Wheels and match as one pose, against the closed form for normal errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/mapping/wheels/pose_filter.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

/// The walls of a corridor along x, 2 m wide, as a robot in its middle sees them; with a wall at its end or without.
KeptScan corridor(bool has_end) {
  std::vector<Point2> points;
  for (int k = -60; k <= 60; ++k) points.emplace_back(0.05 * k, -1.0);
  if (has_end) {
    for (int k = 1; k < 40; ++k) points.emplace_back(3.0, -1.0 + 0.05 * k);
  }
  for (int k = 60; k >= -60; --k) points.emplace_back(0.05 * k, 1.0);
  return keep_scan(points);
}

TEST(PoseFilter, WeighsWheelsAndMatchByTheirVariances) {
  PoseFilter filter;
  filter.predict({1.0, 0.0, 0.0}, {.sigma_m = 0.03, .sigma_rad = 0.01});
  const double variance = 0.03 * 0.03 + 1.0e-6;  // and what the pose before was known by
  const double information = 1.0 / (0.02 * 0.02);
  const PoseFilter::Fused fused =
      filter.fused_with({1.04, 0.0, 0.0}, {.matrix = Matrix3::diagonal(information, information, 1.0e6)});
  const double share = variance * information / (1.0 + variance * information);
  EXPECT_NEAR(fused.T_map_base.x_m, 1.0 + share * 0.04, 1.0e-9);
  EXPECT_NEAR(fused.covariance(0, 0), variance / (1.0 + variance * information), 1.0e-12);
  EXPECT_TRUE(fused.is_possible);
}

TEST(PoseFilter, SaysWhereBothCannotBeRight) {
  PoseFilter filter;
  filter.predict({1.0, 0.0, 0.0}, {.sigma_m = 0.01, .sigma_rad = 0.001});
  const MatchInformation information{.matrix = Matrix3::diagonal(1.0e4, 1.0e4, 1.0e6)};
  EXPECT_TRUE(filter.fused_with({1.03, 0.0, 0.0}, information).is_possible);
  EXPECT_FALSE(filter.fused_with({1.3, 0.0, 0.0}, information).is_possible);
  EXPECT_FALSE(filter.fused_with({1.0, 0.0, 0.05}, information).is_possible);
}

TEST(PoseFilter, AlongABareCorridorTheWheelsAreFollowedAndAcrossItTheMatch) {
  PoseFilter filter;
  filter.predict({1.0, 0.0, 0.0}, {.sigma_m = 0.03, .sigma_rad = 0.01});
  const PoseFilter::Fused bare = filter.fused_with({1.4, 0.04, 0.0}, match_information(corridor(false)));
  EXPECT_TRUE(bare.is_possible);
  EXPECT_NEAR(bare.T_map_base.x_m, 1.0, 0.02);
  EXPECT_NEAR(bare.T_map_base.y_m, 0.04, 0.002);
  const PoseFilter::Fused ended = filter.fused_with({1.03, 0.04, 0.0}, match_information(corridor(true)));
  EXPECT_NEAR(ended.T_map_base.x_m, 1.03, 0.002);
}

// The match tells the heading and where the robot is across the corridor, which is along x of the map: whatever the
// wheels took the heading for, along it stays where they had it.
TEST(PoseFilter, AWrongHeadingOfTheWheelsPushesNothingAlongACorridor) {
  for (const double side : {-1.0, 1.0}) {
    PoseFilter filter;
    filter.predict({0.24, 0.006 * side, 0.05 * side}, {.sigma_m = 0.03, .sigma_rad = 0.05});
    const MatchInformation across{.matrix = Matrix3::diagonal(0.0, 1.0e6, 1.0e8),
                                  .believed = Matrix3::diagonal(0.0, 1.0, 1.0)};
    const PoseFilter::Fused fused = filter.fused_with({0.3, 0.0, 0.0}, across);
    EXPECT_NEAR(fused.T_map_base.x_m, 0.24, 1.0e-6);
    EXPECT_NEAR(fused.T_map_base.y_m, 0.0, 1.0e-4);
    EXPECT_NEAR(fused.T_map_base.theta_rad, 0.0, 1.0e-6);
    EXPECT_NEAR(fused.covariance(0, 0), 0.03 * 0.03, 1.0e-5) << "in the frame of the result";
    EXPECT_NEAR(fused.covariance(1, 1), 1.0e-6, 1.0e-8);
  }
}

// Two things far away in the open, their returns too far apart for a surface: wheels that turn badly do not outweigh
// them.
TEST(PoseFilter, FarReturnsWithoutASurfaceHoldTheHeading) {
  std::vector<Point2> returns;
  for (int k = 0; k < 8; ++k) {
    returns.emplace_back(10.0 + 0.6 * k, -12.0);
    returns.emplace_back(11.0 + 0.6 * k, 12.0);
  }
  std::sort(returns.begin(), returns.end(), [](const Point2& a, const Point2& b) { return a.y() < b.y(); });
  PoseFilter filter;
  filter.predict({1.0, 0.0, 0.0}, {.sigma_m = 0.02, .sigma_rad = 0.05});
  const PoseFilter::Fused fused = filter.fused_with({1.0, 0.0, 0.08}, match_information(keep_scan(returns)));
  EXPECT_TRUE(fused.is_possible);
  EXPECT_NEAR(fused.T_map_base.theta_rad, 0.08, 0.012);
}

}  // namespace
}  // namespace gdtslam

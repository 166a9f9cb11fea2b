// What is found of wheels, fixes and points, from stretches whose noise is known.
#include "engine/mapping/nodding/path_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr int kStepsOfStretch = 30;
constexpr Pose2 kStretchStep{0.05, 0.0, 0.02};

struct TrueNoise {
  double way_m = 0.0;     // per root of a metre
  double turn_rad = 0.0;  // per root of a radian
  double fix_m = 0.0;
};

struct Stretch {
  PoseFix from;
  PoseFix to;
  std::vector<PoseFix> nodes;
};

// By odometry even; the true motion is that and a random walk, and both ends are known but for the noise of a fix.
Stretch stretch_of(const TrueNoise& noise, Random& random) {
  const double walk_m = noise.way_m * std::sqrt(kStretchStep.x_m);
  const double walk_rad = noise.turn_rad * std::sqrt(0.36 * kStretchStep.x_m + kStretchStep.theta_rad);
  const auto fixed = [&](const Pose2& T) {
    return T * Pose2{noise.fix_m * random.normal(), noise.fix_m * random.normal(), 0.3 * noise.fix_m * random.normal()};
  };
  Stretch stretch;
  Pose2 T_odom;
  Pose2 T_map;
  stretch.from = {0.0, fixed(T_map), T_odom};
  for (int k = 1; k <= kStepsOfStretch; ++k) {
    T_odom = T_odom * kStretchStep;
    T_map =
        T_map * kStretchStep * Pose2{walk_m * random.normal(), walk_m * random.normal(), walk_rad * random.normal()};
    stretch.nodes.push_back({0.05 * k, T_map, T_odom});
  }
  stretch.to = stretch.nodes.back();
  stretch.to.T_map_base = fixed(T_map);
  stretch.nodes.pop_back();
  return stretch;
}

SmootherConfig found_after(int stretches, const TrueNoise& noise) {
  Random random(11);
  PathNoise path{SmootherConfig{}};
  for (int k = 0; k < stretches; ++k) {
    const Stretch stretch = stretch_of(noise, random);
    path.take_closing(stretch.from, stretch.to, stretch.nodes);
  }
  return path.found();
}

// Student's t takes numbers that are normal for a seventh less wide than they are.
TEST(PathNoise, FindsTheRandomWalkOfTheWheels) {
  const SmootherConfig good = found_after(400, {.way_m = 0.01, .turn_rad = 0.02, .fix_m = 0.002});
  EXPECT_NEAR(good.odometry_m_per_sqrt_m, 0.01, 0.0033);
  EXPECT_NEAR(good.odometry_rad_per_sqrt_rad, 0.02, 0.004);
  const SmootherConfig poor = found_after(400, {.way_m = 0.04, .turn_rad = 0.12, .fix_m = 0.002});
  EXPECT_NEAR(poor.odometry_m_per_sqrt_m, 0.04, 0.013);
  EXPECT_NEAR(poor.odometry_rad_per_sqrt_rad, 0.12, 0.024);
}

TEST(PathNoise, WheelsThatAreExactAreSoonBelieved) {
  const SmootherConfig guess;
  const SmootherConfig found = found_after(60, {.fix_m = 0.002});
  EXPECT_LT(found.odometry_m_per_sqrt_m, 0.5 * guess.odometry_m_per_sqrt_m);
  EXPECT_LT(found.odometry_rad_per_sqrt_rad, 0.3 * guess.odometry_rad_per_sqrt_rad);
}

TEST(PathNoise, AStandingRobotTellsNothing) {
  PathNoise path{SmootherConfig{}};
  const SmootherConfig before = path.found();
  const PoseFix there{0.0, {1.0, 2.0, 0.3}, {4.0, 5.0, 0.6}};
  for (int k = 0; k < 50; ++k) path.take_closing(there, there, {});
  EXPECT_EQ(path.found().odometry_m_per_sqrt_m, before.odometry_m_per_sqrt_m);
  EXPECT_EQ(path.found().odometry_rad_per_sqrt_rad, before.odometry_rad_per_sqrt_rad);
}

// Of points that ask for motions three times as large as they say they can, on wheels that hardly err.
TEST(PathNoise, PointsThatAreFartherOffThanTheySayWeighLess) {
  SmootherConfig config;
  config.odometry_m_per_sqrt_m = 1e-4;
  config.odometry_rad_per_sqrt_rad = 1e-4;
  Random random(3);
  const Matrix3 information = Matrix3::diagonal(1.0 / square(0.02), 1.0 / square(0.03), 1.0 / square(0.01));
  PathNoise path{config};
  const double before_m = path.found().point_sigma_m;
  for (int k = 0; k < 400; ++k) {
    const Stretch stretch = stretch_of({}, random);
    const Tangent2 motion{0.06 * random.normal(), 0.09 * random.normal(), 0.03 * random.normal()};
    path.take_view(stretch.from, stretch.to, stretch.nodes, stretch.nodes.size() / 2,
                   {information, information * motion});
  }
  EXPECT_NEAR(path.found().point_sigma_m / before_m, 3.0, 0.6);
}

TEST(PathNoise, AViewThatLeavesADirectionOpenTellsNothing) {
  Random random(3);
  const Stretch stretch = stretch_of({}, random);
  PathNoise path{SmootherConfig{}};
  const double before_m = path.found().point_sigma_m;
  path.take_view(stretch.from, stretch.to, stretch.nodes, 10, {Matrix3::diagonal(0.0, 1e4, 1e4), {0.0, 1e3, 0.0}});
  EXPECT_EQ(path.found().point_sigma_m, before_m);
}

}  // namespace
}  // namespace gdtslam

// Wheels that err as a random walk of known size, and matches with known noise.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/wheels/wheel_noise.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

struct Robot {
  double slip_m = 0.0;
  double slip_rad = 0.0;
  double match_m = 0.0;
  double match_rad = 0.0;
};

/// Drives 200 m in steps of 0.3 m with turns.
WheelErrors estimated(const Robot& robot, std::uint64_t seed) {
  Random random(seed);
  WheelNoise noise;
  Pose2 truth;
  Pose2 odometry;
  for (int i = 0; i < 700; ++i) {
    const Pose2 step{0.3, 0.0, (i / 10 % 2 == 0 ? 0.1 : -0.1)};
    const double m = robot.slip_m * std::sqrt(0.3);
    const double r = robot.slip_rad * std::sqrt(0.5 * 0.3 + 0.1);
    const Tangent2 slip{random.normal(0.0, m), random.normal(0.0, m), random.normal(0.0, r)};
    truth = truth * step;
    odometry = odometry * step * exp_tangent(slip);
    const Tangent2 miss{random.normal(0.0, robot.match_m), random.normal(0.0, robot.match_m),
                        random.normal(0.0, robot.match_rad)};
    noise.take(odometry, truth * exp_tangent(miss));
  }
  return noise.errors();
}

class WheelNoiseOf : public testing::TestWithParam<Robot> {};

TEST_P(WheelNoiseOf, IsFoundWithinAThird) {
  const Robot& robot = GetParam();
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const WheelErrors errors = estimated(robot, seed);
    EXPECT_GT(errors.slip_m, 0.67 * robot.slip_m);
    EXPECT_LT(errors.slip_m, 1.5 * robot.slip_m);
    EXPECT_GT(errors.slip_rad, 0.67 * robot.slip_rad);
    EXPECT_LT(errors.slip_rad, 1.5 * robot.slip_rad);
  }
}
INSTANTIATE_TEST_SUITE_P(Robots, WheelNoiseOf,
                         testing::Values(Robot{0.02, 0.01, 0.005, 0.002}, Robot{0.1, 0.1, 0.005, 0.002},
                                         Robot{0.3, 0.3, 0.01, 0.005}, Robot{0.05, 0.2, 0.0, 0.0}));

TEST(WheelNoise, OfWheelsAsGoodAsCanBeIsSmall) {
  const WheelErrors errors = estimated({0.0, 0.0, 0.005, 0.002}, 9);
  EXPECT_LT(errors.slip_m, 0.006);
  EXPECT_LT(errors.slip_rad, 0.004);
  EXPECT_NEAR(errors.match_m, 0.005, 0.002);
  EXPECT_NEAR(errors.match_rad, 0.002, 0.001);
}

TEST(WheelNoise, OneWrongMatchInTwentyIsNotTheWheels) {
  Random random(5);
  WheelNoise noise;
  Pose2 truth;
  for (int i = 0; i < 600; ++i) {
    truth = truth * Pose2{0.3, 0.0, 0.02};
    noise.take(truth, i % 20 == 7 ? truth * Pose2{1.5, 0.5, 0.3} : truth);
  }
  EXPECT_LT(noise.errors().slip_m, 0.05);
  EXPECT_LT(noise.errors().slip_rad, 0.05);
}

TEST(WheelNoise, WithoutOdometryNothingIsLearnt) {
  WheelNoise noise;
  Pose2 truth;
  for (int i = 0; i < 100; ++i) noise.take(std::nullopt, truth = truth * Pose2{0.3, 0.0, 0.0});
  EXPECT_EQ(noise.errors().stretches, 0U);
  EXPECT_GT(noise.of(1.0, 0.0).sigma_m, 0.09);
}

// In a corridor a match slides along: here by a fifth of the way, of wheels that are right.
TEST(WheelNoise, OfAWayThatTheMatchDoesNotKnowIsNotLearnt) {
  const auto drive = [](bool knows_way) {
    WheelNoise noise;
    Pose2 truth;
    Pose2 matched;
    for (int i = 0; i < 600; ++i) {
      const double slid = i % 10 < 5 ? 1.4 : 1.0;
      truth = truth * Pose2{0.3, 0.0, 0.0};
      matched = matched * Pose2{slid * 0.3, 0.0, 0.0};
      noise.take(truth, matched, knows_way);
    }
    return noise;
  };
  EXPECT_GT(drive(true).bias().distance, 0.1);
  const WheelNoise unknown = drive(false);
  EXPECT_EQ(unknown.bias().distance, 0.0);
  EXPECT_DOUBLE_EQ(unknown.errors().slip_m, WheelErrors{}.slip_m) << "as of any robot";
  EXPECT_LT(unknown.errors().slip_rad, 0.01) << "the heading is known";
}

}  // namespace
}  // namespace gdtslam

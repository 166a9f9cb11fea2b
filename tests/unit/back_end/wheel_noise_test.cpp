// Wheels that err as a random walk of known size, and matches with known noise.
#include <gtest/gtest.h>

#include <algorithm>
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

// Their sixth of a radian a root of the metre hides what a match gets wrong: a sixth of a step's error counts at most.
TEST(WheelNoise, BesideBadWheelsWhatIsSeenOfExactMatchesIsChance) {
  const double of_step_rad = 0.17 * std::sqrt(0.5 * 0.3 + 0.1);
  double sum_rad2 = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed)
    sum_rad2 += square(estimated({0.05, 0.17, 0.0, 0.0}, seed).match_rad);
  EXPECT_LT(std::sqrt(sum_rad2 / 40.0), of_step_rad / 6.0);
}

// What wheels get wrong that does not grow with the way, 15 mrad of a pose here as of stamps that are early and late:
// of matches that are exact, beside wheels that err by twice as much a step, two thirds of it are believed at most.
TEST(WheelNoise, OfBadWheelsLittleIsLaidOnTheMatches) {
  double sum_rad2 = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    WheelNoise noise;
    Pose2 truth;
    Pose2 odometry;
    for (int i = 0; i < 700; ++i) {
      truth = truth * Pose2{0.3, 0.0, 0.0};
      odometry = odometry * Pose2{0.3, 0.0, random.normal(0.0, 0.03)};
      noise.take(odometry * Pose2{0.0, 0.0, random.normal(0.0, 0.015)}, truth);
    }
    sum_rad2 += square(noise.errors().match_rad);
  }
  EXPECT_LT(std::sqrt(sum_rad2 / 20.0), 0.015 * 2.0 / 3.0);
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

// Odometry that counts from elsewhere behind a place: 5 m that nobody drove tell nothing of the wheels.
TEST(WheelNoise, WhereThePathBreaksOffNothingIsForgottenOrLearnt) {
  constexpr double kSlip_m = 0.02;  // per root of a metre
  for (const int every : {30, 660}) {
    Random random(3);
    WheelNoise noise;
    Pose2 truth;
    Pose2 odometry;
    for (int i = 0; i < 700; ++i) {
      const Pose2 step{0.3, 0.0, (i / 10 % 2 == 0 ? 0.1 : -0.1)};
      const double m = kSlip_m * std::sqrt(0.3);
      truth = truth * step;
      odometry =
          odometry * step * exp_tangent({random.normal(0.0, m), random.normal(0.0, m), random.normal(0.0, 0.005)});
      const bool is_gone = i % every == every - 1;
      if (is_gone) odometry = Pose2{5.0, 0.0, 1.0} * odometry * Pose2{5.0, 0.0, 0.0};
      is_gone ? noise.break_off() : noise.take(odometry, truth);
    }
    EXPECT_GT(noise.errors().slip_m, 0.67 * kSlip_m) << every;
    EXPECT_LT(noise.errors().slip_m, 1.5 * kSlip_m) << every;
    EXPECT_NEAR(noise.bias().turn, 0.0, 0.01) << every;
  }
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
  EXPECT_GT(drive(true).errors().slip_m, WheelErrors{}.slip_m);
  const WheelNoise unknown = drive(false);
  EXPECT_DOUBLE_EQ(unknown.errors().slip_m, WheelErrors{}.slip_m) << "as of any robot";
  EXPECT_LT(unknown.errors().slip_rad, 0.01) << "the heading is known";
}

// Of perfect wheels the difference over a stretch is that of two matches, whatever its length: twice the variance of
// one.
TEST(WheelNoise, OfMatchesIsFoundWithinAFifth) {
  for (const Robot& robot : {Robot{0.0, 0.0, 0.005, 0.002}, Robot{0.0, 0.0, 0.02, 0.01}}) {
    double sum_m = 0.0;
    double sum_rad = 0.0;
    constexpr int kDrives = 8;
    for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
      const WheelErrors errors = estimated(robot, seed);
      sum_m += errors.match_m;
      sum_rad += errors.match_rad;
    }
    EXPECT_NEAR(sum_m / kDrives, robot.match_m, 0.2 * robot.match_m);
    EXPECT_NEAR(sum_rad / kDrives, robot.match_rad, 0.2 * robot.match_rad);
  }
}

}  // namespace
}  // namespace gdtslam

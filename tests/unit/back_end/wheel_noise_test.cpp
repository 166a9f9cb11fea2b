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

/// So many steps of perfect wheels and matches.
WheelNoise after_perfect(int steps, const Pose2& step) {
  WheelNoise noise;
  Pose2 T;
  for (int k = 0; k < steps; ++k) {
    noise.take(T, T);
    T = T * step;
  }
  return noise;
}

// What is known of no robot goes down to nothing over sixty stretches, and no wheels are believed to be better than
// 3 mm and 2 mrad; below ten stretches of a kind nothing is estimated.
TEST(WheelNoise, TrustGrowsUntilSixtyStretches) {
  for (const int steps : {10, 20, 30, 50, 59, 60, 70, 150}) {
    const WheelErrors errors = after_perfect(steps, {0.25, 0.0, 0.0}).errors();
    const int estimated_at = steps / 10 * 10;  // every tenth
    ASSERT_EQ(errors.stretches, static_cast<std::size_t>(estimated_at));
    const double unknown = estimated_at <= 10 ? 1.0 : std::max(0.0, 1.0 - estimated_at / 60.0);
    EXPECT_NEAR(errors.slip_m, std::max(0.003, 0.1 * unknown), 1e-9) << steps;
    EXPECT_NEAR(errors.slip_rad, std::max(0.002, 0.2 * unknown), 1e-9) << steps;
    EXPECT_NEAR(errors.match_m, 0.0, 1e-9);
    EXPECT_NEAR(errors.match_rad, 0.0, 1e-9);
  }
  EXPECT_EQ(after_perfect(9, {0.25, 0.0, 0.0}).errors().stretches, 0U);
}

// A stretch is a quarter of a metre or of a radian, and the last 400 count.
TEST(WheelNoise, AStretchIsAQuarterOfAMetreOrOfARadian) {
  const auto stretches = [](int steps, const Pose2& step) { return after_perfect(steps, step).errors().stretches; };
  EXPECT_EQ(stretches(40, {0.25, 0.0, 0.0}), 40U);
  EXPECT_EQ(stretches(40, {-0.25, 0.0, 0.0}), 40U);
  EXPECT_EQ(stretches(40, {0.125, 0.0, 0.0}), 20U);
  EXPECT_EQ(stretches(60, {0.0625, 0.1875, 0.0}), 30U) << "0.198 m each";
  EXPECT_EQ(stretches(40, {0.0, 0.0, 0.26}), 40U);
  EXPECT_EQ(stretches(40, {0.0, 0.0, -0.26}), 40U);
  EXPECT_EQ(stretches(60, {0.0, 0.0, 0.12}), 20U) << "three of them";
  EXPECT_EQ(stretches(400, {0.25, 0.0, 0.0}), 400U);
  EXPECT_EQ(stretches(450, {0.25, 0.0, 0.0}), 400U);
}

// A random walk's deviation grows with the root of the way; a metre counts as half a radian of turn.
TEST(WheelNoise, GrowsWithTheRootOfTheWay) {
  const WheelNoise unknown;
  for (const double travelled_m : {0.0, 0.25, 4.0}) {
    for (const double turned_rad : {0.0, 1.5}) {
      const MotionNoise noise = unknown.of(travelled_m, turned_rad);
      EXPECT_NEAR(noise.sigma_m * noise.sigma_m, 1e-6 + 0.01 * travelled_m, 1e-12);
      EXPECT_NEAR(noise.sigma_rad * noise.sigma_rad, 2.5e-7 + 0.04 * (0.5 * travelled_m + turned_rad), 1e-12);
    }
  }
}

}  // namespace
}  // namespace gdtslam

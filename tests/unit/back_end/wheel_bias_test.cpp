// Wheels with a known bias and noise.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/mapping/wheels/wheel_bias.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

struct Wheels {
  double turn_scale = 1.0;  // what they say over what is true
  double rad_per_m = 0.0;   // that they add
  double slip_rad = 0.0;    // over the root of a metre
};

/// Straight stretches and turns, half and half.
std::vector<WheelStretch> drive(const Wheels& wheels, std::size_t count, double wrong_share, Random& random) {
  std::vector<WheelStretch> stretches;
  for (std::size_t i = 0; i < count; ++i) {
    WheelStretch s;
    s.path_m = s.forward_m = random.uniform(0.5, 3.0);
    s.true_turn_rad = i % 2 == 0 ? 0.0 : random.uniform(-1.5, 1.5);
    s.turn_rad = wheels.turn_scale * s.true_turn_rad + wheels.rad_per_m * s.forward_m +
                 random.normal(0.0, wheels.slip_rad * std::sqrt(s.path_m));
    if (random.uniform(0.0, 1.0) < wrong_share) s.true_turn_rad += 1.0;  // a wrong match
    s.turned_rad = std::fabs(s.turn_rad);
    stretches.push_back(s);
  }
  return stretches;
}

// What is missing is 1 / scale - 1 of what the wheels say, and so on.
TEST(WheelBias, IsFoundWithinFourOfItsDeviations) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    Random random(seed);
    const WheelBias bias = estimate_bias(drive({0.97, 0.05, 0.02}, 400, 0.05, random), 1.0);
    EXPECT_NEAR(bias.turn, 1.0 / 0.97 - 1.0, 4.0 * bias.sigma_turn) << seed;
    EXPECT_NEAR(bias.turn_rad_per_m, -0.05 / 0.97, 4.0 * bias.sigma_rad_per_m) << seed;
    EXPECT_LT(bias.sigma_rad_per_m, 0.003) << seed;
  }
}

// A robot that turns on the spot turns by more than half a turn within a stretch, of which matches tell all but the
// whole turns: a twentieth of each turn is missing, by either sign.
TEST(WheelBias, OfTurnsBeyondHalfATurnIsTheSame) {
  std::vector<WheelStretch> stretches;
  for (int k = 1; k <= 60; ++k) {
    WheelStretch s;
    const double true_rad = (k % 2 == 0 ? 1.0 : -1.0) * 0.12 * k;
    s.true_turn_rad = wrap_angle(true_rad);
    s.turn_rad = true_rad / 1.05;
    s.turned_rad = std::fabs(s.turn_rad);
    stretches.push_back(s);
  }
  EXPECT_NEAR(estimate_bias(stretches, 1.0).turn, 0.05, 1.0e-3);
}

TEST(WheelBias, OfGoodWheelsLeavesThemAlone) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    Random random(seed);
    const WheelBias bias = estimate_bias(drive({1.0, 0.0, 0.01}, 200, 0.0, random), 1.0);
    const Pose2 step{1.0, 0.1, 0.3};
    const Pose2 same = corrected(step, bias);
    EXPECT_NEAR(same.x_m, step.x_m, 1.0e-9) << seed;
    EXPECT_NEAR(same.theta_rad, step.theta_rad, 1.0e-9) << seed;
  }
}

TEST(WheelBias, WithoutStretchesIsNothing) {
  const WheelBias bias = estimate_bias({}, 1.0);
  EXPECT_EQ(bias.distance, 0.0);
  EXPECT_EQ(bias.turn_rad_per_m, 0.0);
}

// A metre straight on with 0.1 rad missing is an arc: the end lies half of that to the side.
TEST(CorrectedWheels, TurnWithEachMetre) {
  const WheelBias bias{.distance = 0.0,
                       .turn = 0.0,
                       .turn_rad_per_m = 0.1,
                       .sigma_distance = 0.01,
                       .sigma_turn = 0.01,
                       .sigma_rad_per_m = 1.0e-6};
  const Pose2 step = corrected({1.0, 0.0, 0.0}, bias);
  EXPECT_NEAR(step.theta_rad, 0.1, 1.0e-6);
  EXPECT_NEAR(step.x_m, std::sin(0.1) / 0.1, 1.0e-6);
  EXPECT_NEAR(step.y_m, (1.0 - std::cos(0.1)) / 0.1, 1.0e-6);
}

}  // namespace
}  // namespace gdtslam

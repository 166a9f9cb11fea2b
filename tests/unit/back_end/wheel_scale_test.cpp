// The share of wheels' distances that is missing, against a Kalman filter of all four unknowns in Eigen and against
// drives of wheels whose share is known.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "engine/mapping/wheels/wheel_scale.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr double kPrior = 0.05;
constexpr double kOfMatches = 0.001;
constexpr double kWander = 1.0e-4;  // over the root of a metre

MatchInformation of_sigma(double sigma_m) {
  const double information = 1.0 / (sigma_m * sigma_m);
  return {.matrix = Matrix3::diagonal(information, information, 1.0e6)};
}

TEST(WheelScale, BeforeAnyMatchIsThatOfAnyWheels) {
  WheelScale scale;
  scale.predict({0.5, 0.0, 0.1}, {.sigma_m = 0.01, .sigma_rad = 0.01}, true);
  EXPECT_EQ(scale.told().distance, 0.0);
  EXPECT_NEAR(scale.told().sigma_distance, std::hypot(kPrior, kOfMatches), 1.0e-6);
}

// Straight on all is linear: the way x and the share s, x' = x + (1 + s) d.
TEST(WheelScale, OfAStraightWayIsThatOfALinearFilter) {
  Random random(3);
  WheelScale scale;
  Eigen::Vector2d state(0.0, 0.0);
  Eigen::Matrix2d covariance = Eigen::Vector2d(1.0e-6, kPrior * kPrior).asDiagonal();
  double true_m = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double step_m = random.uniform(0.05, 0.5);
    const double match_m = i % 3 == 0 ? 0.5 : 0.02;
    true_m += 0.98 * step_m;
    const double seen_m = true_m + random.normal(0.0, 0.01);
    const double added = distance_added(scale.told());
    scale.predict({(1.0 + added) * step_m, 0.0, 0.0}, {.sigma_m = 0.02, .sigma_rad = 0.01}, true);
    covariance(1, 1) += kWander * kWander * step_m;
    Eigen::Matrix2d on;
    on << 1.0, step_m, 0.0, 1.0;
    state(0) += (1.0 + state(1)) * step_m;
    covariance = (on * covariance * on.transpose()).eval();
    covariance(0, 0) += 0.02 * 0.02;
    const double off_m = seen_m - state(0);
    const Eigen::Vector2d gain = covariance.col(0) / (covariance(0, 0) + match_m * match_m);
    scale.take({seen_m, 0.0, 0.0}, of_sigma(match_m), {seen_m, 0.0, 0.0});
    state += gain * off_m;
    covariance = (covariance - gain * covariance.row(0)).eval();
    ASSERT_NEAR(scale.told().distance, state(1), 1.0e-9) << i;
    ASSERT_NEAR(scale.told().sigma_distance, std::hypot(std::sqrt(covariance(1, 1)), kOfMatches), 1.0e-9) << i;
  }
  EXPECT_NEAR(state(1), -0.02, 0.005) << "and the drive told it";
}

// Steps that turn, by wheels that slip: of all drives the share is off by as much as the filter says.
TEST(WheelScale, IsAsSureAsItSays) {
  double sum_chi2 = 0.0;
  constexpr int kDrives = 60;
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    Random random(seed);
    const double missing = random.normal(0.0, kPrior);
    WheelScale scale;
    Pose2 truth;
    for (int i = 0; i < 200; ++i) {
      const double turn_rad = i / 20 % 2 == 0 ? 0.05 : -0.1;
      truth = truth * Pose2{(1.0 + missing) * 0.2 + random.normal(0.0, 0.02), random.normal(0.0, 0.02), turn_rad};
      const double added = distance_added(scale.told());
      scale.predict({(1.0 + added) * 0.2, 0.0, turn_rad}, {.sigma_m = 0.02, .sigma_rad = 0.001}, true);
      const Pose2 matched{truth.x_m + random.normal(0.0, 0.05), truth.y_m + random.normal(0.0, 0.05), truth.theta_rad};
      scale.take(matched, of_sigma(0.05), matched);
    }
    const double variance = std::pow(scale.told().sigma_distance, 2) - kOfMatches * kOfMatches;
    sum_chi2 += std::pow(scale.told().distance - missing, 2) / variance;
  }
  EXPECT_GT(sum_chi2 / kDrives, 0.6);
  EXPECT_LT(sum_chi2 / kDrives, 1.5);
}

// Where no odometry measures the motion nothing is learnt of wheels, and where filter and match cannot both be right
// neither.
TEST(WheelScale, IsNotLearntWithoutWheelsNorFromALeap) {
  WheelScale without;
  WheelScale leapt;
  for (int i = 1; i <= 50; ++i) {
    const Pose2 farther{0.11 * i, 0.0, 0.0};
    without.predict({0.1, 0.0, 0.0}, {.sigma_m = 0.05, .sigma_rad = 0.01}, false);
    without.take(farther, of_sigma(0.02), farther);
    leapt.predict({0.1, 0.0, 0.0}, {.sigma_m = 0.01, .sigma_rad = 0.01}, true);
    const Pose2 far{3.0 * i, 0.0, 0.0};
    leapt.take(far, of_sigma(0.02), far);
  }
  EXPECT_EQ(without.told().distance, 0.0);
  EXPECT_EQ(leapt.told().distance, 0.0);
}

}  // namespace
}  // namespace gdtslam

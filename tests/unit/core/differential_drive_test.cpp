#include "gdtslam/core/pose.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

constexpr double kQuarterTurn = std::numbers::pi / 2.0;

// The paper's lateral axis points to the right, y of the result to the left.
TEST(DifferentialDrive, QuarterTurnToTheLeft) {
  const DifferentialDrive drive{.track_width_m = 0.4};
  const double left_m = std::numbers::pi / 4.0;
  const double right_m = 0.45 * std::numbers::pi;
  EXPECT_THAT(wheel_displacement(drive, left_m, right_m), PoseNear({0.7, 0.7, kQuarterTurn}, 1e-12, 1e-12));
  const Pose2 literal = wheel_displacement_literal(drive, left_m, right_m);
  EXPECT_NEAR(literal.x_m, 0.0, 1e-12);
  EXPECT_NEAR(literal.y_m, 0.5, 1e-12);
  EXPECT_NEAR(literal.theta_rad, kQuarterTurn, 1e-12);
}

TEST(DifferentialDrive, GentleCurve) {
  const DifferentialDrive drive{.track_width_m = 0.4};
  const Pose2 pose = wheel_displacement(drive, 0.30, 0.31);
  EXPECT_NEAR(pose.x_m, 0.3050, 5e-5);
  EXPECT_NEAR(pose.y_m, 0.0038, 5e-5);
  EXPECT_NEAR(pose.theta_rad, 0.025, 1e-15);
  const Pose2 literal = wheel_displacement_literal(drive, 0.30, 0.31);
  EXPECT_NEAR(literal.x_m, 11.996, 5e-4);
  EXPECT_NEAR(literal.y_m, 0.29997, 5e-6);
}

TEST(DifferentialDrive, StraightAndOnTheSpot) {
  const DifferentialDrive drive{.track_width_m = 0.4};
  EXPECT_EQ(wheel_displacement(drive, 0.3, 0.3), (Pose2{0.3, 0.0, 0.0}));
  EXPECT_EQ(wheel_displacement(drive, 0.0, 0.0), (Pose2{0.0, 0.0, 0.0}));
  EXPECT_THAT(wheel_displacement(drive, -0.1, 0.1), PoseNear({0.0, 0.0, 0.5}, 1e-15, 1e-12));
  EXPECT_THAT(wheel_displacement(drive, 0.1, -0.1), PoseNear({0.0, 0.0, -0.5}, 1e-15, 1e-12));
}

TEST(DifferentialDrive, OneWheelAtRestTurnsAboutIt) {
  const DifferentialDrive drive{.track_width_m = 0.4};
  // The right wheel goes a quarter of a circle of radius W about the left one, at (0, W/2).
  const double right_m = 0.4 * kQuarterTurn;
  EXPECT_THAT(wheel_displacement(drive, 0.0, right_m), PoseNear({0.2, 0.2, kQuarterTurn}, 1e-15, 1e-12));
  EXPECT_TRUE(std::isnan(wheel_displacement_literal(drive, 0.0, right_m).theta_rad)) << "0/0 as printed";
}

TEST(DifferentialDrive, LiteralFormHasNoStraightMotion) {
  const Pose2 literal = wheel_displacement_literal({.track_width_m = 0.4}, 0.3, 0.3);
  EXPECT_TRUE(std::isinf(literal.x_m));
}

TEST(DifferentialDrive, CentreAheadOfTheAxleSwings) {
  const DifferentialDrive drive{.track_width_m = 0.4, .centre_ahead_of_axle_m = 0.1};
  // On the spot by 90 degrees to the left: O goes from (c, 0) to (0, c) about the axle's middle.
  const double wheel_m = 0.2 * kQuarterTurn;
  EXPECT_THAT(wheel_displacement(drive, -wheel_m, wheel_m), PoseNear({-0.1, 0.1, kQuarterTurn}, 1e-15, 1e-12));
  EXPECT_EQ(wheel_displacement(drive, 0.3, 0.3), (Pose2{0.3, 0.0, 0.0})) << "no swing without a turn";
}

}  // namespace
}  // namespace gdtslam

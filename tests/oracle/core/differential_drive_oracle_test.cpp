// The closed form against the motion itself, integrated wheel by wheel in small steps.
#include "gdtslam/core/pose.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

// Midpoint rule for the axle's middle moving at (l + r)/2 and turning at (r - l)/W; then the centre is read off in the
// frame that it had at the start.
Pose2 integrated(const DifferentialDrive& drive, double left_m, double right_m) {
  constexpr int kSteps = 20000;
  const double forward_m = 0.5 * (left_m + right_m) / kSteps;
  const double turn_rad = (right_m - left_m) / drive.track_width_m / kSteps;
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_rad = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    x_m += forward_m * std::cos(theta_rad + 0.5 * turn_rad);
    y_m += forward_m * std::sin(theta_rad + 0.5 * turn_rad);
    theta_rad += turn_rad;
  }
  // The axle's middle started at (0, 0), the centre at (c, 0).
  const double c = drive.centre_ahead_of_axle_m;
  return {x_m + c * std::cos(theta_rad) - c, y_m + c * std::sin(theta_rad), theta_rad};
}

TEST(DifferentialDriveOracle, MatchesTheIntegratedMotion) {
  std::mt19937_64 engine(1);
  const auto uniform = [&engine](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11U) * 0x1p-53);
  };
  for (int i = 0; i < 200; ++i) {
    const DifferentialDrive drive{.track_width_m = uniform(0.1, 1.0), .centre_ahead_of_axle_m = uniform(-0.5, 0.5)};
    const double left_m = uniform(-1.0, 1.0);
    const double right_m = i % 4 == 0 ? left_m + uniform(-1e-6, 1e-6) : uniform(-1.0, 1.0);
    EXPECT_THAT(wheel_displacement(drive, left_m, right_m), PoseNear(integrated(drive, left_m, right_m), 1e-6, 1e-6))
        << "W " << drive.track_width_m << " c " << drive.centre_ahead_of_axle_m << " L " << left_m << " R " << right_m;
  }
}

// What the literal form does describe: the left wheel about the turning centre, by its length and angle.
TEST(DifferentialDriveOracle, LiteralFormIsTheLeftWheelAboutTheTurningCentre) {
  const DifferentialDrive drive{.track_width_m = 0.5};
  for (const double left_m : {0.2, 0.4, -0.3}) {
    const double right_m = left_m + 0.1;
    const Pose2 literal = wheel_displacement_literal(drive, left_m, right_m);
    const double radius_m = drive.track_width_m * left_m / (right_m - left_m);
    EXPECT_NEAR(std::hypot(literal.x_m, literal.y_m), std::fabs(radius_m), 1e-12);
    EXPECT_NEAR(literal.theta_rad, (right_m - left_m) / drive.track_width_m, 1e-12);
  }
}

}  // namespace
}  // namespace gdtslam

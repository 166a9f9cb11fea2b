// Encoders and odometry against the motion they were made from.
#include "gdtslam/sim/wheel_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::sim {
namespace {

TEST(WheelModel, WithoutErrorsTheOdometryIsTheCircleThatWasDriven) {
  WheelModel wheels;
  wheels.drive.track_width_m = 0.4;
  wheels.ticks_per_m = 20'000.0;
  WheelEncoders encoders(wheels, Random(1));
  WheelOdometer odometer(wheels);
  // Three quarters of a circle of 2 m radius to the left, in 300 steps.
  const double angle = 1.5 * kPi;
  Pose2 T_odom_base;
  for (int i = 0; i < 300; ++i) {
    encoders.advance((2.0 - 0.2) * angle / 300, (2.0 + 0.2) * angle / 300);
    T_odom_base = odometer.update(encoders.ticks());
  }
  // A tick is 0.05 mm; the heading may be off by two of them over the track width.
  EXPECT_NEAR(T_odom_base.x_m, 2.0 * std::sin(angle), 2e-3);
  EXPECT_NEAR(T_odom_base.y_m, 2.0 - 2.0 * std::cos(angle), 2e-3);
  EXPECT_NEAR(T_odom_base.theta_rad, angle - kTwoPi, 2.0 / 20'000.0 / 0.4 + 1e-12);
}

TEST(WheelModel, TicksNeitherGetLostNorAddUp) {
  WheelModel wheels;
  wheels.ticks_per_m = 1000.0;
  WheelEncoders encoders(wheels, Random(1));
  for (int i = 0; i < 100'000; ++i) {
    encoders.advance(0.0003, -0.0003);  // a third of a tick each
  }
  EXPECT_NEAR(static_cast<double>(encoders.ticks().left), 30'000.0, 1.0);
  EXPECT_NEAR(static_cast<double>(encoders.ticks().right), -30'000.0, 1.0);
}

TEST(WheelModel, SystematicErrorsAreThoseOfTheModel) {
  WheelModel wheels;
  wheels.left_scale = 1.01;
  wheels.right_scale = 0.98;
  wheels.ticks_per_m = 1e6;
  WheelEncoders encoders(wheels, Random(1));
  encoders.advance(10.0, 10.0);
  EXPECT_NEAR(static_cast<double>(encoders.ticks().left), 10.1e6, 1.0);
  EXPECT_NEAR(static_cast<double>(encoders.ticks().right), 9.8e6, 1.0);
}

TEST(WheelModel, SlipIsARandomWalkWhateverTheReadingRate) {
  WheelModel wheels;
  wheels.slip_m_per_sqrt_m = 0.02;
  wheels.ticks_per_m = 1e6;
  for (const int steps : {1, 100}) {
    constexpr int kRuns = 4000;
    double sum = 0.0;
    double sum_sq = 0.0;
    double product = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      WheelEncoders encoders(wheels, Random(static_cast<std::uint64_t>(run)));
      for (int i = 0; i < steps; ++i) {
        encoders.advance(9.0 / steps, -9.0 / steps);
      }
      const double left = static_cast<double>(encoders.ticks().left) / 1e6 - 9.0;
      const double right = static_cast<double>(encoders.ticks().right) / 1e6 + 9.0;
      sum += left;
      sum_sq += left * left;
      product += left * right;
    }
    // 2 cm after 1 m is 6 cm after 9 m; five standard errors.
    EXPECT_NEAR(sum / kRuns, 0.0, 5.0 * 0.06 / std::sqrt(kRuns)) << steps;
    EXPECT_NEAR(std::sqrt(sum_sq / kRuns), 0.06, 5.0 * 0.06 / std::sqrt(2.0 * kRuns)) << steps;
    EXPECT_NEAR(product / kRuns, 0.0, 5.0 * 0.0036 / std::sqrt(kRuns)) << steps;
  }
}

}  // namespace
}  // namespace gdtslam::sim

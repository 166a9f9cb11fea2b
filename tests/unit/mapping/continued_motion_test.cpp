// Motions from scan to scan whose changes have a known spread.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "engine/mapping/wheels/continued_motion.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr Tangent2 kSteady{0.1, 0.0, 0.02};  // from scan to scan

TEST(ContinuedMotion, GoesOnAsItDid) {
  ContinuedMotion motion;
  EXPECT_EQ(motion.step(), Pose2{});
  Pose2 pose{3.0, -1.0, 2.5};
  for (int i = 0; i < 3; ++i) {
    motion.take(pose, true);
    pose = pose * exp_tangent(kSteady);
  }
  const Tangent2 step = log_tangent(motion.step());
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(step[k], kSteady[k], 1.0e-12);
}

// Scans whose pose nobody knows are motion all the same: a step is a share of what went on meanwhile.
TEST(ContinuedMotion, IsThatOfAScanAfterScansThatWereNotKnown) {
  ContinuedMotion motion;
  Pose2 pose;
  for (int i = 0; i < 10; ++i) {
    const bool is_known = i < 3 || i == 9;
    motion.take(is_known ? pose : pose * Pose2{0.5, 0.5, 1.0}, is_known);
    if (!is_known) {
      EXPECT_NEAR(motion.step().x_m, exp_tangent(kSteady).x_m, 1.0e-12) << i;
    }
    pose = pose * exp_tangent(kSteady);
  }
  const Tangent2 step = log_tangent(motion.step());
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(step[k], kSteady[k], 1.0e-12);
}

TEST(ContinuedMotion, ItsNoiseIsLearntAndGrowsWhileNothingIsKnown) {
  constexpr double kChange_m = 0.03;
  constexpr double kChange_rad = 0.02;
  Random random(3);
  ContinuedMotion motion;
  const MotionNoise unknown = motion.noise();
  Pose2 pose;
  for (int i = 0; i < 400; ++i) {
    motion.take(pose, true);
    // Steps that scatter by s around a steady one change by s times the root of two.
    pose = pose * exp_tangent({kSteady[0] + random.normal(0.0, kChange_m), random.normal(0.0, kChange_m),
                               kSteady[2] + random.normal(0.0, kChange_rad)});
  }
  const double root_of_two = std::sqrt(2.0);
  EXPECT_NEAR(motion.noise().sigma_m, root_of_two * kChange_m, 0.25 * root_of_two * kChange_m);
  EXPECT_NEAR(motion.noise().sigma_rad, root_of_two * kChange_rad, 0.25 * root_of_two * kChange_rad);
  EXPECT_LT(motion.noise().sigma_m, unknown.sigma_m);
  const double known_m = motion.noise().sigma_m;
  motion.take(pose, false);
  motion.take(pose, false);
  EXPECT_DOUBLE_EQ(motion.noise().sigma_m, 3.0 * known_m);
}

// A robot that turns on the spot now and then is not impossible because it mostly drives straight on.
TEST(ContinuedMotion, RareTurnsCount) {
  ContinuedMotion motion;
  Pose2 pose;
  for (int i = 0; i < 300; ++i) {
    motion.take(pose, true);
    pose = pose * Pose2{0.1, 0.0, i % 20 == 0 ? 0.5 : 0.0};
  }
  EXPECT_GT(motion.noise().sigma_rad, 0.15);
}

}  // namespace
}  // namespace gdtslam

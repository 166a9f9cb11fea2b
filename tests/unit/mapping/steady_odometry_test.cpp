// Odometry without its leaps: from scan to scan a step counts, however long the way between two fixes is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "engine/mapping/nodding/horizontal_scans.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

TEST(SteadyOdometry, StepsThatAreShortEnoughAreGivenAsTheyCame) {
  SteadyOdometry steady(0.5);
  for (int k = 0; k < 100; ++k) {
    const Pose2 T_odom{0.499 * k, 1e5, 0.01 * k};
    EXPECT_EQ(steady.take(T_odom), T_odom);
  }
  EXPECT_EQ(steady.leaps(), 0U);
}

TEST(SteadyOdometry, OverALeapTheRobotStandsAndGoesOnFromThere) {
  SteadyOdometry steady(0.5);
  EXPECT_EQ(steady.take(Pose2{1.0, 2.0, 0.5}), (Pose2{1.0, 2.0, 0.5}));
  const Pose2 far{-400.0, 77.0, -2.0};
  EXPECT_THAT(steady.take(far), testing::Optional(PoseNear({1.0, 2.0, 0.5}, 1e-9, 1e-9)));
  const Pose2 step{0.3, 0.1, 0.2};
  EXPECT_THAT(steady.take(far * step), testing::Optional(PoseNear(Pose2{1.0, 2.0, 0.5} * step, 1e-9, 1e-9)));
  EXPECT_EQ(steady.take(std::nullopt), std::nullopt);
  EXPECT_THAT(steady.take(Pose2{}), testing::Optional(PoseNear(Pose2{1.0, 2.0, 0.5} * step, 1e-9, 1e-9)));
  EXPECT_EQ(steady.leaps(), 2U);
}

TEST(SteadyOdometry, WhatIsNotFiniteIsNone) {
  SteadyOdometry steady(0.5);
  EXPECT_EQ(steady.take(Pose2{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}), std::nullopt);
  EXPECT_EQ(steady.take(Pose2{3.0, 0.0, 0.0}), (Pose2{3.0, 0.0, 0.0}));
  EXPECT_EQ(steady.take(Pose2{0.0, 0.0, std::numeric_limits<double>::infinity()}), std::nullopt);
  EXPECT_EQ(steady.take(Pose2{3.1, 0.0, 0.0}), (Pose2{3.1, 0.0, 0.0}));
  EXPECT_EQ(steady.leaps(), 0U);
}

}  // namespace
}  // namespace gdtslam

// Prediction from odometry, and without it. Expected poses are composed by hand.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/mapping/match/motion_estimate.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

// Drives the model one step: odometry in, estimate back.
Prediction step(MotionModel& model, const std::optional<Pose2>& odometry, const Pose2& estimate) {
  const Prediction prediction = model.predict(odometry);
  model.correct(estimate, true);
  return prediction;
}

TEST(MotionModel, MovesTheLastEstimateByTheOdometryInItsOwnFrame) {
  MotionModel model{OdometryConfig{}};
  step(model, Pose2{10.0, 5.0, 0.0}, Pose2{});
  step(model, Pose2{10.0, 5.0, 0.0}, Pose2{1.0, 2.0, M_PI / 2});
  // Forward 0.5 in the odometry frame is up in the map, where the robot looks up.
  const Prediction p = model.predict(Pose2{10.5, 5.0, 0.1});
  EXPECT_THAT(p.T_map_base, PoseNear({1.0, 2.5, M_PI / 2 + 0.1}, 1e-9, 1e-7));
  EXPECT_NEAR(p.travelled_m, 0.5, 1e-12);
  EXPECT_NEAR(p.turned_rad, 0.1, 1e-12);
  EXPECT_TRUE(p.by_odometry);
}

TEST(MotionModel, WithoutOdometryTheLastMotionGoesOn) {
  MotionModel model{OdometryConfig{}};
  step(model, std::nullopt, Pose2{});
  step(model, std::nullopt, Pose2{0.3, 0.0, 0.2});
  const Prediction p = model.predict(std::nullopt);
  EXPECT_FALSE(p.by_odometry);
  EXPECT_THAT(p.T_map_base, PoseNear({0.3 + 0.3 * std::cos(0.2), 0.3 * std::sin(0.2), 0.4}, 1e-9, 1e-7));
}

TEST(MotionModel, APoseThatIsNotFiniteCountsAsNone) {
  MotionModel model{OdometryConfig{}};
  step(model, Pose2{}, Pose2{});
  EXPECT_FALSE(step(model, Pose2{std::nan(""), 0, 0}, Pose2{}).by_odometry);
  EXPECT_FALSE(step(model, Pose2{0, std::numeric_limits<double>::infinity(), 0}, Pose2{}).by_odometry);
  // The good pose before the bad ones is still the one to go on from.
  EXPECT_THAT(model.predict(Pose2{0.2, 0, 0}).T_map_base, PoseNear({0.2, 0, 0}, 1e-12, 1e-9));
}

// Each is a number, what lies between them is none.
TEST(MotionModel, ATurnThatIsNotFiniteCountsAsNone) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  MotionModel model{OdometryConfig{}};
  step(model, Pose2{0, 0, kLargest}, Pose2{});
  const Prediction p = step(model, Pose2{0, 0, -kLargest}, Pose2{});
  EXPECT_FALSE(p.by_odometry);
  EXPECT_TRUE(p.T_map_base.is_finite());
}

TEST(MotionModel, OdometryThatLeapsIsCountedAndNotUsed) {
  OdometryConfig config;
  config.max_step_m = 2.0;
  MotionModel model{config};
  step(model, Pose2{}, Pose2{});
  const Prediction p = step(model, Pose2{50.0, 0.0, 0.0}, Pose2{});
  EXPECT_FALSE(p.by_odometry);
  EXPECT_EQ(model.leaps(), 1U);
  EXPECT_THAT(p.T_map_base, PoseNear(Pose2{}, 1e-12, 1e-9));
  EXPECT_TRUE(model.predict(Pose2{50.1, 0.0, 0.0}).by_odometry) << "the step after the leap is an honest one";
}

TEST(MotionModel, BetweenScansSecondsApartTheLongestStepCountsForEachSecond) {
  OdometryConfig config;
  config.max_step_m = 2.0;
  const auto is_used = [&](double step_m, double elapsed_s) {
    MotionModel model{config};
    model.predict(Pose2{});
    return model.predict(Pose2{step_m, 0.0, 0.0}, elapsed_s).by_odometry;
  };
  EXPECT_TRUE(is_used(5.9, 3.0));
  EXPECT_FALSE(is_used(6.1, 3.0));
  EXPECT_TRUE(is_used(1.9, 0.1));
  EXPECT_FALSE(is_used(2.1, 0.1));
  EXPECT_FALSE(is_used(2.1, -7.0)) << "a clock that was set back";
}

TEST(MotionModel, OdometryThatStandsStillWhileScansMoveIsTakenAsMissing) {
  OdometryConfig config;
  config.frozen_m = 0.25;
  MotionModel model{config};
  const Pose2 still{3.0, 4.0, 0.5};
  step(model, still, Pose2{});
  EXPECT_TRUE(step(model, still, Pose2{0.1, 0, 0}).by_odometry);
  EXPECT_TRUE(step(model, still, Pose2{0.2, 0, 0}).by_odometry);
  EXPECT_TRUE(step(model, still, Pose2{0.3, 0, 0}).by_odometry);
  const Prediction p = step(model, still, Pose2{0.4, 0, 0});
  EXPECT_FALSE(p.by_odometry);
  EXPECT_THAT(p.T_map_base, PoseNear({0.4, 0, 0}, 1e-9, 1e-7));
  EXPECT_TRUE(step(model, Pose2{3.1, 4.0, 0.5}, Pose2{0.5, 0, 0}).by_odometry) << "it moves again: it is trusted again";
}

/// The model after four scans 0.2 m apart in which the odometry stood still.
MotionModel after_a_stop(bool estimate) {
  OdometryConfig config;
  config.estimate = estimate;
  MotionModel model{config};
  step(model, Pose2{5.0, 0.0, 0.0}, Pose2{});
  for (int k = 1; k <= 4; ++k) step(model, Pose2{5.0, 0.0, 0.0}, Pose2{0.2 * k, 0, 0});
  return model;
}

TEST(MotionModel, OdometryThatTellsLateWhatItMissedIsLaidOnWhereItStopped) {
  MotionModel model = after_a_stop(true);
  EXPECT_THAT(model.predict(Pose2{6.02, 0.0, 0.0}).T_map_base, PoseNear({1.02, 0, 0}, 1e-9, 1e-7));
  EXPECT_TRUE(model.has_caught_up());
  model.correct(Pose2{1.0, 0, 0}, true);
  EXPECT_THAT(model.predict(Pose2{6.22, 0.0, 0.0}).T_map_base, PoseNear({1.2, 0, 0}, 1e-9, 1e-7)) << "once, not again";
  EXPECT_FALSE(model.has_caught_up());
}

TEST(MotionModel, OdometryThatNeverTellsWhatItMissedGoesOnFromTheLastPose) {
  MotionModel model = after_a_stop(true);
  EXPECT_THAT(model.predict(Pose2{5.21, 0.0, 0.0}).T_map_base, PoseNear({1.01, 0, 0}, 1e-9, 1e-7));
  EXPECT_FALSE(model.has_caught_up());
}

// An odometry pose that was interpolated over the leap has 0.2 m of it, and the next one the other 1.0 m. The robot
// went on by 0.2 m a scan all the time.
TEST(MotionModel, WhatOdometryMissedMayComeInTwoParts) {
  MotionModel model = after_a_stop(true);
  EXPECT_THAT(step(model, Pose2{5.2, 0.0, 0.0}, Pose2{1.0, 0, 0}).T_map_base, PoseNear({1.0, 0, 0}, 1e-9, 1e-7));
  EXPECT_FALSE(model.has_caught_up());
  EXPECT_THAT(step(model, Pose2{6.2, 0.0, 0.0}, Pose2{1.2, 0, 0}).T_map_base, PoseNear({1.2, 0, 0}, 1e-9, 1e-7));
  EXPECT_TRUE(model.has_caught_up());
  EXPECT_THAT(step(model, Pose2{6.4, 0.0, 0.0}, Pose2{1.4, 0, 0}).T_map_base, PoseNear({1.4, 0, 0}, 1e-9, 1e-7));
  EXPECT_FALSE(model.has_caught_up()) << "once, not again";
}

TEST(MotionModel, WithoutEstimatesAStepIsAStep) {
  EXPECT_THAT(after_a_stop(false).predict(Pose2{6.02, 0.0, 0.0}).T_map_base, PoseNear({1.82, 0, 0}, 1e-9, 1e-7));
}

}  // namespace
}  // namespace gdtslam

// A robot that drives on in a room, with odometry that is good, missing, or leaps.
#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "engine/mapping/match/motion_estimate.hpp"

namespace gdtslam {
namespace {

constexpr Pose2 kMotion{0.1, 0.0, 0.02};  // from scan to scan

/// The walls of a room of 6 m by 4 m around the robot, in beam order.
std::vector<Point2> room() {
  std::vector<Point2> points;
  for (int i = -50; i <= 50; ++i) points.emplace_back(3.0, 0.04 * i);
  for (int i = 75; i >= -75; --i) points.emplace_back(0.04 * i, 2.0);
  for (int i = 50; i >= -50; --i) points.emplace_back(-3.0, 0.04 * i);
  for (int i = -75; i <= 75; ++i) points.emplace_back(0.04 * i, -2.0);
  return points;
}

/// Two walls along the way, which tell nothing of it.
std::vector<Point2> corridor() {
  std::vector<Point2> points;
  for (int i = 75; i >= -75; --i) points.emplace_back(0.04 * i, 2.0);
  for (int i = -75; i <= 75; ++i) points.emplace_back(0.04 * i, -2.0);
  return points;
}

class Drive : public testing::Test {
 protected:
  /// What becomes of a match at this pose. The scan fits nowhere else.
  MatchResult drive_to(const Pose2& T_map_matched, const std::optional<Pose2>& T_odom_base) {
    const Prediction prediction = estimate_.predict(model_, T_odom_base, 0.2 * ++scans_);
    MatchResult result;
    result.T_map_predicted = prediction.T_map_base;
    result.T_map_base = T_map_matched;
    result.accepted = true;
    is_by_odometry_ = prediction.by_odometry;
    estimate_.take(result, true, keep_scan(points_), [this](const Pose2&, const Pose2&) { return fits_as_well_; });
    model_.correct(result.T_map_base, result.accepted);
    return result;
  }

  int scans_ = 0;
  MotionModel model_{OdometryConfig{}};
  MotionEstimate estimate_;
  std::vector<Point2> points_ = room();
  bool is_by_odometry_ = false;
  bool fits_as_well_ = false;  // at the first pose as at the second
};

TEST_F(Drive, OdometryThatNeverMovedIsNone) {
  Pose2 pose;
  for (int i = 0; i < 10; ++i) {
    const MatchResult result = drive_to(pose, Pose2{5.0, 6.0, 0.7});
    EXPECT_TRUE(i == 0 || !is_by_odometry_) << i;
    EXPECT_TRUE(i == 0 || result.odometry_sigma_m >= 1.0) << i;
    EXPECT_TRUE(result.accepted) << i;
    pose = pose * kMotion;
  }
}

TEST_F(Drive, TheFirstStepThatOdometryMovesCounts) {
  drive_to({}, Pose2{5.0, 6.0, 0.7});
  const MatchResult result = drive_to(kMotion, Pose2{5.0, 6.0, 0.7} * kMotion);
  EXPECT_TRUE(is_by_odometry_);
  EXPECT_NEAR(result.T_odometry_step.x_m, kMotion.x_m, 1.0e-12);
  EXPECT_NEAR(result.T_odometry_step.theta_rad, kMotion.theta_rad, 1.0e-12);
}

// A building seen the wrong way round looks the same.
TEST_F(Drive, ALeapThatNothingSpeaksForIsRefused) {
  Pose2 pose;
  for (int i = 0; i < 5; ++i) {
    drive_to(pose, std::nullopt);
    pose = pose * kMotion;
  }
  const MatchResult result = drive_to(pose * Pose2{1.0, 0.0, 3.1}, std::nullopt);
  EXPECT_FALSE(result.accepted);
  EXPECT_EQ(result.doubt, Doubt::kWeakEvidence);
  EXPECT_EQ(result.T_map_base, result.T_map_predicted);
}

TEST_F(Drive, WhereTheOdometryLeapsTheMatchStands) {
  Pose2 pose;
  Pose2 odometry;
  for (int i = 0; i < 5; ++i) {
    drive_to(pose, odometry);
    pose = pose * kMotion;
    odometry = odometry * kMotion;
  }
  const MatchResult result = drive_to(pose, odometry * Pose2{2.0, 0.0, 1.5});
  EXPECT_TRUE(result.accepted);
  EXPECT_NEAR(result.T_map_base.x_m, pose.x_m, 0.05);
  EXPECT_NEAR(result.T_map_base.theta_rad, pose.theta_rad, 0.02);
}

// Wheels that turn by 0.3 rad too much, as where they are stamped late in a corner: the scan says whether it would fit
// so.
TEST_F(Drive, OfAMatchThatLeapsTheScanSaysWhetherTheTurnIsOpen) {
  for (const bool fits : {false, true}) {
    estimate_ = MotionEstimate();
    model_ = MotionModel(OdometryConfig{});
    Pose2 pose;
    Pose2 odometry;
    for (int i = 0; i < 300; ++i) {
      EXPECT_TRUE(drive_to(pose, odometry).is_turn_open) << "nobody asked";
      pose = pose * kMotion;
      odometry = odometry * kMotion;
    }
    fits_as_well_ = fits;
    const MatchResult result = drive_to(pose, odometry * Pose2{0.0, 0.0, 0.3});
    ASSERT_TRUE(result.accepted);
    EXPECT_EQ(result.is_turn_open, fits);
    fits_as_well_ = false;
  }
}

// The wheels say 4 % too much of each way: in a room, whose walls tell it, the prediction is right soon. 0.2 % are left
// as they are, since matches may be off by as much.
TEST_F(Drive, WhatWheelsGetWrongOfEachWayIsLearnt) {
  for (const auto& [wrong, left] : {std::pair{1.04, 0.0}, std::pair{1.002, 0.002}}) {
    estimate_ = MotionEstimate();
    model_ = MotionModel(OdometryConfig{});
    Pose2 pose;
    Pose2 odometry;
    double predicted_m = 0.0;
    for (int i = 0; i < 400; ++i) {
      const Pose2 before = pose;
      pose = pose * kMotion;
      odometry = odometry * Pose2{wrong * kMotion.x_m, 0.0, kMotion.theta_rad};
      const MatchResult result = drive_to(pose, odometry);
      if (i >= 300) predicted_m += between(before, result.T_map_predicted).x_m;
    }
    EXPECT_NEAR(predicted_m / (100 * kMotion.x_m) - 1.0, left, 0.002) << wrong;
  }
}

// A match along a corridor may be anywhere. Who has not moved yet stands for as long as the scan fits there, too, and
// is not held once it did move.
TEST_F(Drive, WhoStandsIsMovedByNoMatchThatFitsThereAsWell) {
  points_ = corridor();
  fits_as_well_ = true;
  const Pose2 odometry{5.0, 6.0, 0.7};
  for (int i = 0; i < 20; ++i) EXPECT_EQ(drive_to({0.03 * i, 0.0, 0.0}, odometry).T_map_base, Pose2{}) << i;
  points_ = room();
  fits_as_well_ = false;
  EXPECT_NEAR(drive_to({0.1, 0.0, 0.0}, odometry).T_map_base.x_m, 0.1, 0.01);
  fits_as_well_ = true;
  EXPECT_GT(drive_to({0.2, 0.0, 0.0}, odometry).T_map_base.x_m, 0.12);
}

// What the scan does tell is believed, though it fits about as well where the robot stood: few points may see the end.
TEST_F(Drive, WhoStandsIsMovedByAMatchThatKnowsTheWay) {
  fits_as_well_ = true;
  drive_to({}, std::nullopt);
  EXPECT_NEAR(drive_to({0.1, 0.0, 0.0}, std::nullopt).T_map_base.x_m, 0.1, 0.01);
}

// Who says where in a map a robot is may be some cells off: the first match tells better.
TEST_F(Drive, WhoseFirstPoseIsAGuessGoesToWhereItsScanFits) {
  estimate_ = MotionEstimate(MotionEstimate::FirstPose::kGuess);
  fits_as_well_ = true;
  EXPECT_NEAR(drive_to({0.05, 0.0, 0.0}, std::nullopt).T_map_base.x_m, 0.05, 0.01);
}

TEST_F(Drive, WhatOdometryMeasuresIsNotHeld) {
  fits_as_well_ = true;
  drive_to({}, Pose2{});
  EXPECT_NEAR(drive_to(kMotion, kMotion).T_map_base.x_m, kMotion.x_m, 0.01);
  EXPECT_NEAR(drive_to(kMotion * kMotion, std::nullopt).T_map_base.x_m, (kMotion * kMotion).x_m, 0.02);
}

// Odometry that comes and goes: where it is missing the motion goes on as it did, not as far as over the gap.
TEST_F(Drive, AMotionGoesOnAsItWasFromScanToScan) {
  Pose2 pose;
  for (int i = 0; i < 30; ++i) {
    const bool is_seen = i < 20 || i == 25;
    const MatchResult result = drive_to(is_seen ? pose : pose * Pose2{5.0, 5.0, 2.0}, std::nullopt);
    EXPECT_EQ(result.accepted, is_seen) << i;
    if (i > 1) {
      EXPECT_NEAR(result.T_map_predicted.x_m, pose.x_m, 0.01) << i;
      EXPECT_NEAR(result.T_map_predicted.theta_rad, pose.theta_rad, 0.01) << i;
    }
    pose = pose * kMotion;
  }
}

}  // namespace
}  // namespace gdtslam

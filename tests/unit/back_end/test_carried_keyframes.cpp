// Keyframes that follow their places, where it can be said by hand where they come to lie.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/mapping/loops/carried_keyframes.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

void expect_pose(const Pose2& found, const Pose2& expected) {
  EXPECT_NEAR(found.x_m, expected.x_m, 1e-12);
  EXPECT_NEAR(found.y_m, expected.y_m, 1e-12);
  EXPECT_NEAR(wrap_angle(found.theta_rad - expected.theta_rad), 0.0, 1e-12);
}

/// A keyframe each metre along x, and what becomes of them.
std::vector<Pose2> carried(std::size_t keyframes, const std::vector<std::size_t>& places,
                           const std::vector<Pose2>& of_places) {
  std::vector<Pose2> shape;
  for (std::size_t k = 0; k < keyframes; ++k) shape.push_back({static_cast<double>(k), 0.0, 0.0});
  std::vector<Pose2> poses = shape;
  carry_keyframes_between(places, of_places, shape, poses);
  return poses;
}

TEST(CarriedKeyframes, WhatAPlaceMovedByIsSpreadOverTheWayToIt) {
  for (const double sign : {-1.0, 1.0}) {
    const std::vector<Pose2> farther = carried(5, {0, 4}, {{}, {4.0 + sign * 0.4, 0.0, 0.0}});
    const std::vector<Pose2> aside = carried(5, {0, 4}, {{}, {4.0, sign * 0.4, 0.0}});
    for (std::size_t k = 0; k < 5; ++k) {
      const auto x = static_cast<double>(k);
      expect_pose(farther[k], {x + sign * 0.1 * x, 0.0, 0.0});
      expect_pose(aside[k], {x, sign * 0.1 * x, 0.0});
    }
  }
}

TEST(CarriedKeyframes, BehindAPlaceTheSharesBeginAnew) {
  for (const double sign : {-1.0, 1.0}) {
    const std::vector<Pose2> poses = carried(7, {0, 2, 6}, {{}, {2.2, 0.0, 0.0}, {6.2, sign * 0.4, 0.0}});
    for (std::size_t k = 0; k < 7; ++k) {
      const auto x = static_cast<double>(k);
      expect_pose(poses[k], k < 2 ? Pose2{1.1 * x, 0.0, 0.0} : Pose2{0.2 + x, sign * 0.1 * (x - 2.0), 0.0});
    }
  }
}

// A turn of the end is one about the end, of which each keyframe before it gets its share.
TEST(CarriedKeyframes, WhatAPlaceTurnedByTurnsThoseBeforeItAboutIt) {
  for (const double turn_rad : {-0.4, 0.4}) {
    const std::vector<Pose2> poses = carried(5, {0, 4}, {{}, {4.0, 0.0, turn_rad}});
    for (std::size_t k = 0; k < 5; ++k) {
      const double share_rad = 0.25 * static_cast<double>(k) * turn_rad;
      const double before_m = 4.0 - static_cast<double>(k);
      expect_pose(poses[k], {4.0 - before_m * std::cos(share_rad), -before_m * std::sin(share_rad), share_rad});
    }
  }
}

TEST(CarriedKeyframes, BehindTheLastPlaceThePathKeepsItsShape) {
  const Pose2 T{1.0, -2.0, 0.7};
  // The third place is not in the graph yet.
  const std::vector<Pose2> poses = carried(8, {0, 2, 6}, {{}, T});
  for (std::size_t k = 2; k < 8; ++k) expect_pose(poses[k], T * Pose2{static_cast<double>(k) - 2.0, 0.0, 0.0});
}

TEST(CarriedKeyframes, AllThatLieAlikeToEachOtherMoveAsOne) {
  const Pose2 T{1.0, -2.0, 2.5};
  const std::vector<Pose2> poses = carried(8, {0, 3, 6}, {T, T * Pose2{3.0, 0.0, 0.0}, T * Pose2{6.0, 0.0, 0.0}});
  for (std::size_t k = 0; k < 8; ++k) expect_pose(poses[k], T * Pose2{static_cast<double>(k), 0.0, 0.0});
}

TEST(CarriedKeyframes, ThoseBeforeTheFirstPlaceStay) {
  const std::vector<Pose2> poses = carried(4, {2, 3}, {{2.0, 5.0, 0.0}, {3.0, 5.0, 0.0}});
  for (const std::size_t k : {0U, 1U}) expect_pose(poses[k], {static_cast<double>(k), 0.0, 0.0});
  for (const std::size_t k : {2U, 3U}) expect_pose(poses[k], {static_cast<double>(k), 5.0, 0.0});
}

}  // namespace
}  // namespace gdtslam

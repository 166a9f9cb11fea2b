// How far keyframes may lie from where a group has them: what a wall tells that the group's middle did not see itself
// is as sure as the way between the two. Frame: that of the middle. Thread-safe to read; linear in the keyframes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Covariances of where a keyframe lies, as the front end states them: tangents at the keyframe.
struct StepDoubt {
  Matrix3 step;    ///< covariance of the step from the one before; these add up
  Matrix3 unseen;  ///< covariance of the keyframe itself along unseen directions; these do not add up
};

class GroupDoubt {
 public:
  /// Keyframes one after the other at `in_middle`, seen from the one with number `middle`. Without `doubts` they lie
  /// where they are said to.
  GroupDoubt(std::span<const StepDoubt> doubts, std::span<const Pose2> in_middle, std::size_t middle);

  /// Covariance of a pose that is the least squares over the points of all keyframes, as far as it comes from where
  /// these lie: first-order propagation, each step moving all keyframes behind it. `shapes`: the sum of J^T J over each
  /// keyframe's points, for motions in the middle's frame.
  [[nodiscard]] Matrix3 of_pose(std::span<const Matrix3> shapes) const;

 private:
  std::size_t middle_;
  std::vector<Matrix3> steps_;  // to each keyframe, and of each, in the frame of the middle
  std::vector<Matrix3> unseen_;
};

}  // namespace gdtslam

// The share that is missing in the wheels' distances, learnt from matches as the log goes: a fourth unknown of a Kalman
// filter beside the pose. Where a scan lies by its match is compared with where the wheels since the last ones put it,
// and the covariance between pose and share tells how much of what is off is the share's. The length of matched steps
// would not do: where a match tells little, they lean on the wheels themselves. Frame: map. Not thread-safe. Cost: a
// dozen products of 3 x 3 matrices a scan.
#pragma once

#include "engine/mapping/wheels/pose_filter.hpp"
#include "engine/mapping/wheels/wheel_bias.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

class WheelScale {
 public:
  /// The robot moved by this step. If odometry measured it (`by_wheels`), the step is the one that the `distance` of
  /// told() has corrected.
  void predict(const Pose2& step, const MotionNoise& noise, bool by_wheels);
  /// The scan was matched at the first pose. The second one stands if filter and match cannot both be right.
  void take(const Pose2& T_map_matched, const MatchInformation& match, const Pose2& T_map_base);
  /// A bias of nothing but this share, with its standard deviation.
  [[nodiscard]] WheelBias told() const;

 private:
  PoseFilter filter_;
  double missing_ = 0.0;
  double variance_ = 0.05 * 0.05;
  Tangent2 with_pose_{};  // covariance of the share and the pose
};

}  // namespace gdtslam

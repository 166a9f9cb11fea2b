// Learns the missing share of the wheels' distances from matches: a fourth unknown of a Kalman filter beside the pose.
// The matched pose of a scan is compared with the pose by the wheels, and the covariance between pose and share decides
// how much of the difference belongs to the share. The length of matched steps is not used: if a match has little
// information, it leans on the wheels. Frame: map. Not thread-safe. Cost: a dozen products of 3 x 3 matrices a scan.
#pragma once

#include "engine/mapping/wheels/pose_filter.hpp"
#include "engine/mapping/wheels/wheel_bias.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

class WheelScale {
 public:
  /// The robot moved by this step. If odometry measured it (`by_wheels`), the step is already corrected by the
  /// `distance` of told().
  void predict(const Pose2& step, const MotionNoise& noise, bool by_wheels);
  /// The scan was matched at the first pose. The second one is used if filter and match cannot both be right.
  void take(const Pose2& T_map_matched, const MatchInformation& match, const Pose2& T_map_base);
  /// A bias of this share alone, with its standard deviation.
  [[nodiscard]] WheelBias told() const;

 private:
  PoseFilter filter_;
  double missing_ = 0.0;
  double variance_ = 0.05 * 0.05;
  Tangent2 with_pose_{};  // covariance of the share and the pose
};

}  // namespace gdtslam

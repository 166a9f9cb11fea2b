#include "gdtslam/mapping/motion_model.hpp"

#include <algorithm>
#include <cmath>

namespace gdtslam {

std::optional<Pose2> MotionModel::odometry_motion(const std::optional<Pose2>& T_odom_base) {
  if (!T_odom_base || !T_odom_base->is_finite()) return std::nullopt;
  const std::optional<Pose2> before = last_odometry_;
  last_odometry_ = T_odom_base;
  if (!before) return std::nullopt;
  const Pose2 motion = between(*before, *T_odom_base);
  if (motion.translation().norm() > config_.max_step_m) {
    ++leaps_;
    return std::nullopt;
  }
  stands_still_ = *before == *T_odom_base;
  if (!stands_still_) frozen_m_ = frozen_rad_ = 0.0;
  const bool frozen = frozen_m_ > config_.frozen_m || frozen_rad_ > config_.frozen_rad;
  return frozen ? std::nullopt : std::optional(motion);
}

Prediction MotionModel::predict(const std::optional<Pose2>& T_odom_base) {
  stands_still_ = false;
  const std::optional<Pose2> motion = odometry_motion(T_odom_base);
  if (motion) {
    return {T_map_base_ * *motion, motion->translation().norm(), std::fabs(motion->theta_rad), true};
  }
  return {T_map_base_ * last_motion_, std::max(last_motion_.translation().norm(), config_.unknown_step_m),
          std::max(std::fabs(last_motion_.theta_rad), config_.unknown_turn_rad), false};
}

void MotionModel::correct(const Pose2& T_map_base, bool matched) {
  last_motion_ = between(T_map_base_, T_map_base);
  T_map_base_ = T_map_base;
  if (stands_still_ && matched) {
    frozen_m_ += last_motion_.translation().norm();
    frozen_rad_ += std::fabs(last_motion_.theta_rad);
  }
}

}  // namespace gdtslam

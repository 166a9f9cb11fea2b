#include "motion_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gdtslam {
namespace {

// Estimated odometry has a narrow search window: when it stands still while the robot turns, the next scans are soon
// matched with the wrong walls.
constexpr double kFrozen_m = 0.1;
constexpr double kFrozen_rad = 0.1;

// A radian counts as a metre: kOfAnyRobot.
double squared_change(const Pose2& from, const Pose2& to) {
  const Pose2 moved = between(from, to);
  return moved.x_m * moved.x_m + moved.y_m * moved.y_m + moved.theta_rad * moved.theta_rad;
}

}  // namespace

bool is_within_reach(const UncertainPose& expected, const Pose2& T_map_base) {
  const Pose2 off = between(expected.T_map_base, T_map_base);
  const double m = (off.x_m * off.x_m + off.y_m * off.y_m) / (expected.noise.sigma_m * expected.noise.sigma_m);
  const double rad = off.theta_rad * off.theta_rad / (expected.noise.sigma_rad * expected.noise.sigma_rad);
  return m + rad < kReachSigmas * kReachSigmas;
}

std::optional<Pose2> MotionModel::odometry_motion(const std::optional<Pose2>& T_odom_base, double elapsed_s) {
  if (!T_odom_base || !T_odom_base->is_finite()) return std::nullopt;
  const std::optional<Pose2> before = last_odometry_;
  last_odometry_ = T_odom_base;
  if (!before) return std::nullopt;
  const Pose2 motion = between(*before, *T_odom_base);
  if (!(motion.translation().norm() <= config_.max_step_m * std::max(1.0, elapsed_s)) ||
      !motion.is_finite()) {  // NaN too
    ++leaps_;
    resumed_ = std::nullopt;
    return std::nullopt;
  }
  if (!(*before == *T_odom_base)) {
    if (T_map_stop_) {
      resumed_ = Resumed{*T_map_stop_, *before, frozen_};
    } else if (resumed_ && !std::exchange(resumed_->may_tell_later, false)) {
      resumed_ = std::nullopt;
    }
    T_map_stop_ = std::nullopt;
    frozen_ = false;
  } else {
    resumed_ = std::nullopt;
    if (!T_map_stop_) T_map_stop_ = T_map_base_;
  }
  return frozen_ ? std::nullopt : std::optional(motion);
}

// Odometry that stood still for some scans either missed what the robot did meanwhile or tells it now, all at once; a
// robot does not leap, so it is what goes on more nearly as the robot went.
Pose2 MotionModel::moved_by(const Pose2& motion) {
  const Pose2 missed = T_map_base_ * motion;
  has_caught_up_ = false;
  if (!config_.estimate || !resumed_) return missed;
  const Pose2 told = resumed_->T_map_stop * between(resumed_->T_odom_stop, *last_odometry_);
  const Pose2 going_on = T_map_base_ * last_motion_;
  has_caught_up_ = squared_change(told, going_on) < squared_change(missed, going_on);
  if (!has_caught_up_) return missed;
  resumed_ = std::nullopt;
  return told;
}

Prediction MotionModel::predict(const std::optional<Pose2>& T_odom_base, double elapsed_s) {
  const std::optional<Pose2> motion = odometry_motion(T_odom_base, elapsed_s);
  if (motion) {
    return {moved_by(*motion), motion->translation().norm(), std::fabs(motion->theta_rad), true};
  }
  return {T_map_base_ * last_motion_, std::max(last_motion_.translation().norm(), config_.unknown_step_m),
          std::max(std::fabs(last_motion_.theta_rad), config_.unknown_turn_rad), false};
}

void MotionModel::correct(const Pose2& T_map_base, bool matched) {
  last_motion_ = between(T_map_base_, T_map_base);
  T_map_base_ = T_map_base;
  if (T_map_stop_ && matched) {
    const Pose2 since = between(*T_map_stop_, T_map_base);
    const double most_m = config_.estimate ? std::min(config_.frozen_m, kFrozen_m) : config_.frozen_m;
    const double most_rad = config_.estimate ? std::min(config_.frozen_rad, kFrozen_rad) : config_.frozen_rad;
    frozen_ = frozen_ || since.translation().norm() > most_m || std::fabs(since.theta_rad) > most_rad;
  }
}

}  // namespace gdtslam

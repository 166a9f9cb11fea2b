#include "steady_odometry.hpp"

namespace gdtslam {

std::optional<Pose2> SteadyOdometry::take(const std::optional<Pose2>& T_odom_base) {
  if (!T_odom_base || !T_odom_base->is_finite()) return std::nullopt;
  if (T_odom_last_) {
    const Pose2 step = between(*T_odom_last_, *T_odom_base);
    if (!(step.translation().norm() <= max_step_m_) || !step.is_finite()) {  // NaN too
      ++leaps_;
      T_steady_odom_ = T_steady_odom_.value_or(Pose2{}) * *T_odom_last_ * inverse(*T_odom_base);
    }
  }
  T_odom_last_ = T_odom_base;
  return T_steady_odom_ ? *T_steady_odom_ * *T_odom_base : *T_odom_base;
}

}  // namespace gdtslam

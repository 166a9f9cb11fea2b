#include "wheel_scale.hpp"

#include <cmath>

namespace gdtslam {
namespace {

constexpr double kWander = 1.0e-4;  // drift of the share over the root of a metre: tyres wear and warm
// Matches may be off by a share of the way as well, always to the same side: their information about the wheels is
// limited by that, however many there are.
constexpr double kOfMatches = 0.001;

Matrix3 heading_turned(double by_rad) { return adjoint_matrix(Pose2{0.0, 0.0, by_rad}); }

}  // namespace

void WheelScale::predict(const Pose2& step, const MotionNoise& noise, bool by_wheels) {
  if (!by_wheels) {
    const Matrix3 carried = adjoint_matrix(inverse(step));
    filter_.predict(filter_.pose() * step, noise);
    with_pose_ = carried * with_pose_;
    return;
  }
  const Point2 way = (1.0 / (1.0 + distance_added(told()))) * step.translation();
  const Point2 moved = (1.0 + missing_) * way;
  const Pose2 longer{moved.x(), moved.y(), step.theta_rad};
  const Point2 ahead = Pose2{0.0, 0.0, -step.theta_rad} * way;
  const Tangent2 by_share{ahead.x(), ahead.y(), 0.0};
  const Tangent2 carried = adjoint_matrix(inverse(longer)) * with_pose_;
  filter_.predict(filter_.pose() * longer, noise);
  variance_ += kWander * kWander * way.norm();
  filter_.take(filter_.pose(), filter_.covariance() + outer(carried, by_share) + outer(by_share, carried) +
                                   variance_ * outer(by_share, by_share));
  for (std::size_t k = 0; k < with_pose_.size(); ++k) with_pose_[k] = carried[k] + variance_ * by_share[k];
}

// The share given the pose is normal: its mean moves by c' P^-1 dx, and its variance falls by the part of the pose's
// variance that P^-1 c sees.
void WheelScale::take(const Pose2& T_map_matched, const MatchInformation& match, const Pose2& T_map_base) {
  const PoseFilter::Fused fused = filter_.fused_with(T_map_matched, match);
  if (!fused.is_possible) {
    filter_.take(T_map_base, inverse(match.matrix));
    with_pose_ = {};
    return;
  }
  const Pose2 moved = between(filter_.pose(), fused.T_map_base);
  const Tangent2 gain = inverse(filter_.covariance()) * with_pose_;
  const Tangent2 in_result = heading_turned(-moved.theta_rad) * gain;
  missing_ += dot(gain, {moved.x_m, moved.y_m, moved.theta_rad});
  variance_ -= squared_norm(filter_.covariance(), gain) - squared_norm(fused.covariance, in_result);
  with_pose_ = fused.covariance * in_result;
  filter_.take(fused.T_map_base, fused.covariance);
}

WheelBias WheelScale::told() const {
  WheelBias bias;
  bias.distance = missing_;
  bias.sigma_distance = std::sqrt(variance_ + kOfMatches * kOfMatches);
  return bias;
}

}  // namespace gdtslam

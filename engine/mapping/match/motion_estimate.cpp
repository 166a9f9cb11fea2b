#include "motion_estimate.hpp"

namespace gdtslam {
namespace {

constexpr MotionNoise kUnknownMotion{0.2, 0.2};  // of a motion that nothing measured, about the last one
constexpr double kMostChi2 = 30.0;               // of what may still be such a motion
constexpr MotionNoise kNothingSaid{10.0, 3.0};   // of what odometry said of it

}  // namespace

Prediction MotionEstimate::predict(MotionModel& model, const std::optional<Pose2>& T_odom_base) {
  const std::optional<Pose2> before = T_odom_last_;
  const Pose2 T_map_before = model.pose();
  T_map_continued_ = model.continued();
  Prediction prediction = model.predict(corrected(T_odom_base));
  step_ = prediction.by_odometry ? between(*before, *T_odom_base) : between(T_map_before, prediction.T_map_base);
  is_measured_ = prediction.by_odometry;
  noise_ = is_measured_ ? wheels_.of(prediction.travelled_m, prediction.turned_rad) : kUnknownMotion;
  filter_.predict(prediction.T_map_base, noise_);
  prediction.noise = filter_.sigma();
  return prediction;
}

std::optional<Pose2> MotionEstimate::corrected(const std::optional<Pose2>& T_odom_base) {
  if (!T_odom_base || !T_odom_base->is_finite()) return odometry_ = std::nullopt;
  if (T_odom_last_) {
    const Pose2 step = between(*T_odom_last_, *T_odom_base);
    has_moved_ = has_moved_ || !(*T_odom_last_ == *T_odom_base);
    if (!has_moved_) return odometry_ = std::nullopt;  // logs without odometry state one pose again and again
    T_odom_corrected_ = T_odom_corrected_ * wheels_.corrected(step);
  }
  T_odom_last_ = odometry_ = T_odom_base;
  return T_odom_corrected_;
}

// Whether the robot may have moved on as it did before, whatever the odometry says.
bool MotionEstimate::goes_on(const Pose2& T_map_base) const {
  const Pose2 off = between(T_map_continued_, T_map_base);
  const double m = (off.x_m * off.x_m + off.y_m * off.y_m) / (kUnknownMotion.sigma_m * kUnknownMotion.sigma_m);
  const double rad = off.theta_rad * off.theta_rad / (kUnknownMotion.sigma_rad * kUnknownMotion.sigma_rad);
  return m + rad < kMostChi2;
}

void MotionEstimate::take(MatchResult& result, bool is_matched, std::span<const Point2> points_base_m,
                          const FitsAsWell& fits_as_well) {
  result.T_odometry_step = step_;
  result.odometry_sigma_m = is_measured_ ? noise_.sigma_m : kNothingSaid.sigma_m;
  result.odometry_sigma_rad = is_measured_ ? noise_.sigma_rad : kNothingSaid.sigma_rad;
  const bool is_sure = result.accepted && result.doubt == Doubt::kNone;
  wheels_.take(odometry_, is_sure ? std::optional(result.T_map_base) : std::nullopt);
  if (!result.accepted || !is_matched) return;
  const Matrix3 information = match_information(keep_scan(points_base_m));
  const PoseFilter::Fused fused = filter_.fused_with(result.T_map_base, information);
  const bool is_leap = !fused.is_possible && !goes_on(result.T_map_base);
  if (!fused.is_possible && (is_leap || result.doubt == Doubt::kWeakEvidence)) {
    result.accepted = false;
    result.doubt = Doubt::kWeakEvidence;
    result.T_map_base = result.T_map_predicted;
  } else if (fused.is_possible || fits_as_well(fused.T_map_base, result.T_map_base)) {
    filter_.take(fused.T_map_base, fused.covariance);
    result.T_map_base = fused.T_map_base;
  } else {
    filter_.take(result.T_map_base, inverse(information));
  }
}

}  // namespace gdtslam

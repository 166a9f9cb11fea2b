#include "motion_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/mapping/wheels/turn_leap.hpp"

namespace gdtslam {
namespace {

// Estimated odometry has a narrow search window: if it stands still while the robot turns, the next scans are soon
// matched with the wrong walls.
constexpr double kFrozen_m = 0.1;
constexpr double kFrozen_rad = 0.1;

// A radian counts as a metre, see kOfAnyRobot.
double squared_change(const Pose2& from, const Pose2& to) {
  const Pose2 moved = between(from, to);
  return moved.x_m * moved.x_m + moved.y_m * moved.y_m + moved.theta_rad * moved.theta_rad;
}

constexpr MotionNoise kNothingSaid{10.0, 3.0};  // noise of a motion that the odometry did not measure

MotionNoise larger(const MotionNoise& a, const MotionNoise& b) {
  return {std::max(a.sigma_m, b.sigma_m), std::max(a.sigma_rad, b.sigma_rad)};
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

// Odometry that stood still for some scans has either missed the motion meanwhile or reports it now, all at once. A
// robot does not leap, so the case closer to the continued motion counts.
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

std::vector<Point2> MotionEstimate::points_to_match(const PointScan& scan, int fewest) {
  const std::span seen_m = std::span(scan.points_base_m).first(scan.points_base_m.size() - scan.unknown_points);
  if (has_moved_) {
    std::vector<Point2> kept_m = known_surfaces().without_wall_ends(seen_m, filter_.pose());
    if (kept_m.size() >= static_cast<std::size_t>(fewest)) return kept_m;
  }
  return {seen_m.begin(), seen_m.end()};
}

// Without any measurement the motion continues, with the reliability observed so far.
Prediction MotionEstimate::predict(MotionModel& model, const std::optional<Pose2>& T_odom_base, double stamp_s) {
  const std::optional<Pose2> before = T_odom_last_;
  Prediction prediction = model.predict(corrected(T_odom_base), stamp_s - std::exchange(stamp_last_s_, stamp_s));
  is_measured_ = prediction.by_odometry;
  T_map_last_ = model.pose();
  stands_ = stands_ && !is_measured_;
  if (is_measured_) {
    step_ = model.has_caught_up() ? between(model.pose(), prediction.T_map_base) : between(*before, *T_odom_base);
    noise_ = wheels_.of(prediction.travelled_m, prediction.turned_rad);
  } else {
    step_ = continued_.step();
    noise_ = continued_.noise();
    prediction.T_map_base = model.pose() * step_;
  }
  going_on_ = going_on(model);
  filter_.predict(prediction.T_map_base, noise_);
  scale_.predict(between(T_map_last_, prediction.T_map_base), noise_, is_measured_);
  prediction.noise = stands_ ? larger(filter_.sigma(), kOfAnyRobot) : filter_.sigma();  // it may drive off
  prediction.otherwise = going_on_;
  return prediction;
}

UncertainPose MotionEstimate::going_on(const MotionModel& model) const {
  const MotionNoise noise = is_measured_ ? kOfAnyRobot : larger(kOfAnyRobot, continued_.noise());
  return {model.pose() * continued_.step(), noise};
}

std::optional<Pose2> MotionEstimate::corrected(const std::optional<Pose2>& T_odom_base) {
  if (!T_odom_base || !T_odom_base->is_finite()) return odometry_ = std::nullopt;
  if (T_odom_last_) {
    const Pose2 step = between(*T_odom_last_, *T_odom_base);
    has_moved_ = has_moved_ || !(*T_odom_last_ == *T_odom_base);
    if (!has_moved_) return odometry_ = std::nullopt;  // logs without odometry repeat one pose
    wheels_.set_distance(scale_.told());
    T_odom_corrected_ = T_odom_corrected_ * wheels_.corrected(step);
  }
  T_odom_last_ = odometry_ = T_odom_base;
  return T_odom_corrected_;
}

void MotionEstimate::take(MatchResult& result, bool is_matched, const KeptScan& scan, const FitsAsWell& fits_as_well) {
  result.T_odometry_step = step_;
  result.odometry_sigma_m = is_measured_ ? noise_.sigma_m : kNothingSaid.sigma_m;
  result.odometry_sigma_rad = is_measured_ ? noise_.sigma_rad : kNothingSaid.sigma_rad;
  result.predicted_sigma_m = noise_.sigma_m;
  result.predicted_sigma_rad = noise_.sigma_rad;
  result.match_sigma_m = wheels_.errors().match_m;
  result.match_sigma_rad = wheels_.errors().match_rad;
  const bool is_settled = result.accepted && is_matched;
  const bool is_sure = result.accepted && result.doubt == Doubt::kNone;
  wheels_.take(odometry_, is_sure ? std::optional(result.T_map_base) : std::nullopt,
               is_settled && knows_way(scan, inverse(step_).translation()));
  if (is_settled) settle(result, scan, fits_as_well);
  if (is_settled && result.accepted && find_leap(result)) {
    Pose2 turned = result.T_map_base;
    turned.theta_rad = result.T_map_predicted.theta_rad;
    result.is_turn_open = fits_as_well(turned, result.T_map_base);
  }
  continued_.take(result.T_map_base, result.accepted);
}

// A robot counts as standing as long as its scans fit its old pose as well as any and do not contradict it: along a
// corridor the pose would otherwise wander, and the motion continue. If few points see the corridor's ends, the fit
// hardly changes for long, but their information shows the motion. Motion suppressed until then does not continue.
void MotionEstimate::settle(MatchResult& result, const KeptScan& scan, const FitsAsWell& fits_as_well) {
  const MatchInformation information = match_information(known_ ? known_->known_part(scan, result.T_map_base) : scan);
  if (stands_) {
    stands_ =
        !are_apart(T_map_last_, result.T_map_base, information.matrix) && fits_as_well(T_map_last_, result.T_map_base);
    if (!stands_) {
      continued_ = ContinuedMotion{};
      filter_.predict(T_map_last_, kOfAnyRobot);
    }
  }
  if (stands_) result.T_map_base = T_map_last_;
  const Pose2 T_map_matched = result.T_map_base;
  const PoseFilter::Fused fused = filter_.fused_with(T_map_matched, information);
  const bool is_leap = !fused.is_possible && !is_within_reach(going_on_, result.T_map_base);
  if (!fused.is_possible && (is_leap || result.doubt == Doubt::kWeakEvidence)) {
    result.accepted = false;
    result.doubt = Doubt::kWeakEvidence;
    result.T_map_base = result.T_map_predicted;
    return;
  }
  if (fused.is_possible || fits_as_well(fused.T_map_base, result.T_map_base)) {
    filter_.take(fused.T_map_base, fused.covariance);
    result.T_map_base = fused.T_map_base;
  } else {
    filter_.take(result.T_map_base, inverse(information.matrix));
  }
  scale_.take(T_map_matched, information, result.T_map_base);
}

}  // namespace gdtslam

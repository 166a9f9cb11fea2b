#include "turn_leap.hpp"

#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kStraight_s = 1.5;  // longer than the delay of early or late odometry
constexpr double kStraight_rad = 0.035;
constexpr double kTurnNoise_rad = 0.01;  // noise of the matches at both ends
constexpr double kTurnChi2 = 25.0;
constexpr double kUnmeasuredTurn_rad = 1.0;  // a larger sigma marks a step that no odometry measured

}  // namespace

bool TurnLeap::is_straight(const MatchResult& result, double off_rad) {
  by_wheels_rad_ += result.T_odometry_step.theta_rad;
  by_match_rad_ += result.T_odometry_step.theta_rad + off_rad;
  if (std::fabs(by_match_rad_) > kStraight_rad || std::fabs(by_wheels_rad_) > kStraight_rad) {
    by_match_rad_ = by_wheels_rad_ = 0.0;
    straight_since_s_ = result.stamp_s;
  }
  return result.stamp_s - straight_since_s_ >= kStraight_s;
}

// A leap whose turn is open was handled when it happened.
std::optional<double> TurnLeap::take(const MatchResult& result) {
  const double off_rad = wrap_angle(result.T_map_base.theta_rad - result.T_map_predicted.theta_rad);
  const bool is_behind = is_straight(result, off_rad);
  if (!(result.odometry_sigma_rad < kUnmeasuredTurn_rad)) {
    off_rad_ = variance_rad2_ = 0.0;
    return std::nullopt;
  }
  variance_rad2_ += square(result.predicted_sigma_rad);
  if (!(find_leap(result) && result.is_turn_open)) off_rad_ += off_rad;
  if (!is_behind) return std::nullopt;
  const double variance = variance_rad2_ + square(kTurnNoise_rad) + 2.0 * square(result.match_sigma_rad);
  const bool leapt = square(off_rad_) > kTurnChi2 * variance;
  const std::optional<double> leap = leapt ? std::optional(off_rad_) : std::nullopt;
  off_rad_ = variance_rad2_ = 0.0;
  return leap;
}

}  // namespace gdtslam

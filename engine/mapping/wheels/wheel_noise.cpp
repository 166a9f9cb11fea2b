#include "wheel_noise.hpp"

#include <algorithm>
#include <cmath>

#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {
namespace {

constexpr double kMarkEvery_m = 0.25;
constexpr double kMarkEvery_rad = 0.25;
constexpr std::size_t kMostMarks = 400;
constexpr std::size_t kEstimateEvery = 10;  // marks
constexpr std::size_t kFewestStretches = 10;
constexpr double kMovedShare = 0.1;  // share of a metre for each mark: shorter stretches do not count
// Share of the stretches below a quantile, and that quantile for the length of two normal variables, or for one, in
// sigmas.
constexpr double kQuantile = 0.85;
constexpr double kQuantileOfTwo = 1.948;  // sqrt(-2 log(1 - 0.85))
constexpr double kQuantileOfOne = 1.440;
// Relative variance of that quantile squared, times the number of stretches: 4 q (1 - q) / (x f(x))^2 at x = 1.44 of
// the absolute value of a normal variable.
constexpr double kQuantileNoise = 3.07;
constexpr double kBeyondChance = 2.0;  // standard errors of the level at which half of it counts
constexpr double kFullTrust = 60.0;    // marks; with fewer, the noise of an unknown robot counts too
constexpr WheelErrors kUnknown;
constexpr double kLeastSlip_m = 0.003;
constexpr double kLeastSlip_rad = 0.002;
constexpr double kLeastSigma_m = 0.001;
constexpr double kLeastSigma_rad = 0.0005;
constexpr std::size_t kBiasMarks = 8;  // marks of a stretch: long compared with a match's error

double quantile(std::vector<double>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

double hypotenuse(double a, double b) { return std::sqrt(a * a + b * b); }

}  // namespace

MotionNoise WheelNoise::of(double travelled_m, double turned_rad) const {
  return {hypotenuse(kLeastSigma_m, errors_.slip_m * std::sqrt(travelled_m)),
          hypotenuse(kLeastSigma_rad, errors_.slip_rad * std::sqrt(heading_walk(travelled_m, turned_rad)))};
}

void WheelNoise::take(const std::optional<Pose2>& T_odom_base, const std::optional<Pose2>& T_map_base, bool knows_way) {
  if (!T_odom_base) {
    marks_.clear();
    last_.reset();
    return;
  }
  if (last_) {
    const Pose2 step = between(*last_, *T_odom_base);
    path_m_ += translation_length(step);
    turned_rad_ += std::fabs(step.theta_rad);
    forward_m_ += step.x_m;
    turn_rad_ += step.theta_rad;
  }
  last_ = T_odom_base;
  if (!T_map_base) return;
  if (!marks_.empty() && marks_.back().breaks == breaks_ && path_m_ - marks_.back().path_m < kMarkEvery_m &&
      turned_rad_ - marks_.back().turned_rad < kMarkEvery_rad) {
    return;
  }
  marks_.push_back({*T_odom_base, *T_map_base, path_m_, turned_rad_, forward_m_, turn_rad_, knows_way, breaks_});
  if (marks_.size() > kMostMarks) marks_.pop_front();
  if (++taken_ % kEstimateEvery == 0) estimate();
}

void WheelNoise::break_off() {
  ++breaks_;
  last_.reset();
}

void WheelNoise::spreads_over(std::size_t marks, const std::vector<Pose2>& odometry, std::vector<Spread>& metres,
                              std::vector<Spread>& radians) const {
  std::vector<double> off_m;
  std::vector<double> path;
  std::vector<double> off_rad;
  std::vector<double> walk;
  for (std::size_t i = 0; i + marks < marks_.size(); ++i) {
    const Mark& from = marks_[i];
    const Mark& to = marks_[i + marks];
    if (from.breaks != to.breaks) continue;
    const Tangent2 off =
        log_tangent(between(between(odometry[i], odometry[i + marks]), between(from.T_map_base, to.T_map_base)));
    const double path_m = to.path_m - from.path_m;
    if (from.knows_way && to.knows_way && path_m > kMovedShare * static_cast<double>(marks)) {
      off_m.push_back(hypotenuse(off[0], off[1]));
      path.push_back(path_m);
    }
    off_rad.push_back(std::fabs(off[2]));
    walk.push_back(heading_walk(path_m, to.turned_rad - from.turned_rad));
  }
  const auto add = [&](std::vector<double>& off, std::vector<double>& length, double sigmas,
                       std::vector<Spread>& spreads) {
    if (off.size() <= kFewestStretches) return;
    const double sigma = quantile(off, kQuantile) / sigmas;
    const double weight = static_cast<double>(off.size()) / static_cast<double>(marks);  // they overlap
    spreads.push_back({quantile(length, 0.5), sigma * sigma, weight});
  };
  add(off_m, path, kQuantileOfTwo, metres);
  add(off_rad, walk, kQuantileOfOne, radians);
}

// Least squares of the relative errors; neither the wheels nor the matches can have a negative variance. Beside far
// worse wheels the level of the matches is a difference of large numbers. It counts as far as it exceeds its own
// standard error and the wheels' error from mark to mark, a part of which does not grow with the way either, for
// example if stamps are early or late.
WheelNoise::Line WheelNoise::fit(const std::vector<Spread>& spreads, double slope_before) {
  constexpr double kTiny = 1.0e-12;
  double w = 0.0, x = 0.0, v = 0.0, xx = 0.0, xv = 0.0;
  for (const Spread& spread : spreads) {
    const double weight = spread.weight / (spread.variance * spread.variance + kTiny);
    w += weight;
    x += weight * spread.path;
    v += weight * spread.variance;
    xx += weight * spread.path * spread.path;
    xv += weight * spread.path * spread.variance;
  }
  const double determinant = w * xx - x * x;
  if (!(determinant > 0.0)) return {slope_before, 0.0, 0.0};
  Line line{(w * xv - x * v) / determinant, 0.0, 0.0};
  line.level = (v - line.slope * x) / w;
  const double of_wheels = square(std::max(0.0, line.slope) * spreads.front().path);
  const double chance = square(kBeyondChance) * kQuantileNoise * xx / determinant + of_wheels;
  line.sure_level = line.level * square(line.level) / (square(line.level) + chance);
  if (line.level < 0.0) line = {xv / xx, 0.0, 0.0};
  if (line.slope < 0.0) line = {0.0, v / w, v / w};
  return line;
}

Pose2 WheelNoise::corrected(const Pose2& by_wheels) const { return gdtslam::corrected(by_wheels, bias_); }

std::vector<WheelStretch> WheelNoise::stretches() const {
  std::vector<WheelStretch> all;
  for (std::size_t i = 0; i + kBiasMarks < marks_.size(); ++i) {
    const Mark& from = marks_[i];
    const Mark& to = marks_[i + kBiasMarks];
    if (from.breaks != to.breaks) continue;
    all.push_back({.path_m = to.path_m - from.path_m,
                   .turned_rad = to.turned_rad - from.turned_rad,
                   .forward_m = to.forward_m - from.forward_m,
                   .turn_rad = to.turn_rad - from.turn_rad,
                   .true_turn_rad = between(from.T_map_base, to.T_map_base).theta_rad});
  }
  return all;
}

std::vector<Pose2> WheelNoise::corrected_marks() const {
  std::vector<Pose2> path{Pose2{}};
  for (std::size_t i = 1; i < marks_.size(); ++i) {
    path.push_back(path.back() * corrected(between(marks_[i - 1].T_odom_base, marks_[i].T_odom_base)));
  }
  return path;
}

void WheelNoise::estimate() {
  std::vector<Spread> metres;
  std::vector<Spread> radians;
  const WheelBias before = bias_;
  bias_ = estimate_bias(stretches(), static_cast<double>(kBiasMarks));
  set_distance(before);
  const std::vector<Pose2> odometry = corrected_marks();
  for (const std::size_t marks : {1U, 2U, 4U, 8U}) spreads_over(marks, odometry, metres, radians);
  const Line line_m = fit(metres, errors_.slip_m * errors_.slip_m);
  const Line line_rad = fit(radians, errors_.slip_rad * errors_.slip_rad);
  const auto slip = [](const Line& line, std::size_t marks, double unknown, double least) {
    const double trust = std::min(1.0, static_cast<double>(marks) / kFullTrust);
    return std::max(least, trust * std::sqrt(line.slope) + (1.0 - trust) * unknown);
  };
  const auto knowing_way = std::count_if(marks_.begin(), marks_.end(), [](const Mark& mark) { return mark.knows_way; });
  errors_ = {.slip_m = slip(line_m, static_cast<std::size_t>(knowing_way), kUnknown.slip_m, kLeastSlip_m),
             .slip_rad = slip(line_rad, marks_.size(), kUnknown.slip_rad, kLeastSlip_rad),
             .match_m = std::sqrt(0.5 * line_m.sure_level),
             .match_rad = std::sqrt(0.5 * line_rad.sure_level),
             .stretches = marks_.size()};
}

}  // namespace gdtslam

#include "measured_path.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/mapping/wheels/wheel_noise.hpp"

namespace gdtslam {
namespace {

constexpr double kBiasStep = 1.0e-4;  // step of a difference quotient

// The variance of matches is never reduced: loops tie nearby keyframes, which share a map and are matched best.
constexpr double kLeastOfMatches = 1.0;
constexpr double kFarBetter = 0.25;    // share of the variance
constexpr double kVeryGood = 0.2;      // factor of the variance of wheels
constexpr std::size_t kFewAPlace = 8;  // keyframes from one place to the next
constexpr std::size_t kFewestOff = 12;
constexpr double kOffQuantile = 0.85;  // quantile, and its value for the absolute value of a normal variable
constexpr double kOffSigmas = 1.440;

// Estimates the factor of the stated variances, from errors in units of their standard deviations.
double estimate_factor(std::vector<double>& off) {
  const auto at = off.begin() + static_cast<std::ptrdiff_t>(kOffQuantile * static_cast<double>(off.size() - 1));
  std::nth_element(off.begin(), at, off.end());
  return std::clamp(square(*at / kOffSigmas), kLeastVarianceFactor, kMostVarianceFactor);
}

std::vector<PoseRelation> to_relations(const std::vector<WheelRelation>& wheels) {
  std::vector<PoseRelation> relations;
  relations.reserve(wheels.size());
  for (const WheelRelation& step : wheels) relations.push_back(step.relation);
  return relations;
}

VarianceFactor at_least(VarianceFactor factor, double least) {
  factor.variance = std::max(factor.variance, least);
  factor.turn_variance = std::max(factor.turn_variance, least);
  return factor;
}

// The bias without its uncertainty, so that corrected() applies all of it.
WheelBias plain(const WheelBias& bias) { return {bias.distance, bias.turn, bias.turn_rad_per_m, 0.0, 0.0, 0.0}; }

// Derivative of a step's tangent with respect to the bias, at this bias.
Matrix3 change_with_bias(const Pose2& by_wheels, const WheelBias& bias) {
  const WheelBias at = plain(bias);
  const Pose2 T = corrected(by_wheels, at);
  Matrix3 change;
  for (int k = 0; k < 3; ++k) {
    WheelBias moved = at;
    (k == 0 ? moved.distance : k == 1 ? moved.turn : moved.turn_rad_per_m) += kBiasStep;
    const Tangent2 by = log_tangent(between(T, corrected(by_wheels, moved)));
    for (int row = 0; row < 3; ++row) change(row, k) = by[static_cast<std::size_t>(row)] / kBiasStep;
  }
  return change;
}

}  // namespace

MeasuredPath::MeasuredPath(const FrontEndPath& path, std::vector<std::size_t> places)
    : path_(path), places_(std::move(places)) {}

void MeasuredPath::correct_wheels(PoseGraph& graph) {
  if (graph.wheels.empty()) return;
  bias_.distance += graph.bias[0];
  bias_.turn += graph.bias[1];
  bias_.turn_rad_per_m += graph.bias[2];
  graph.bias = {};
  const Matrix3 covariance = GraphCovariance(graph).of_bias();
  bias_.sigma_distance = std::sqrt(covariance(0, 0));
  bias_.sigma_turn = std::sqrt(covariance(1, 1));
  bias_.sigma_rad_per_m = std::sqrt(covariance(2, 2));
}

void MeasuredPath::state_wheel_noise(const std::vector<Pose2>& keyframes) {
  if (path_.travels.empty()) return;
  constexpr auto kWheels = static_cast<std::size_t>(StepSource::kWheels);
  WheelNoise noise;
  noise.set_distance(bias_);
  Pose2 T_odom_base;
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const Pose2& step = path_.steps_to(i)[kWheels].T;
    T_odom_base = T_odom_base * step;
    const WheelTravel& travel = path_.travels[i];
    if (!travel.is_matched) {
      noise.break_off();
      continue;
    }
    noise.take(travel.is_measured ? std::optional(T_odom_base) : std::nullopt, keyframes[i], travel.is_way_known);
  }
  if (noise.errors().stretches == 0) return;
  wheel_information_.clear();
  wheel_information_.reserve(path_.travels.size());
  for (const WheelTravel& travel : path_.travels) {
    const MotionNoise sigma = noise.of(travel.path_m, travel.turned_rad);
    const Matrix3 walk = Matrix3::diagonal(square(sigma.sigma_m), square(sigma.sigma_m), square(sigma.sigma_rad));
    wheel_information_.push_back(inverse(walk + travel.besides));
  }
}

WheelRelation MeasuredPath::between_places(std::size_t place, StepSource source, Information information) const {
  WheelRelation relation = stated(places_[place - 1], places_[place], source, information);
  relation.relation.from = place - 1;
  relation.relation.to = place;
  return relation;
}

WheelRelation MeasuredPath::stated(std::size_t from, std::size_t to, StepSource source, Information information) const {
  return source == StepSource::kWheels ? wheels_between(from, to) : matches_between(from, to, information);
}

// Adds the covariances of the steps, each carried to the frame of the last, which grow as the map drifts; and, from
// place to place and to the end, the covariance along directions that surfaces leave free.
WheelRelation MeasuredPath::matches_between(std::size_t from, std::size_t to, Information information) const {
  Pose2 T;
  Matrix3 covariance;
  auto place = std::upper_bound(places_.begin(), places_.end(), from);
  for (std::size_t i = from + 1; i <= to; ++i) {
    const MeasuredStep& step = path_.steps_to(i)[0];
    const Matrix3 carried = adjoint_matrix(inverse(step.T));
    covariance = carried * times_transposed(covariance, carried) + inverse(step.*information);
    const bool is_place = place != places_.end() && *place == i;
    if (is_place || i == to) covariance += step.blind;
    if (is_place) ++place;
    T = T * step.T;
  }
  return {.relation = {.from = from, .to = to, .T_from_to = T, .information = inverse(covariance)}, .by_bias = {}};
}

// Distances come from the wheels, headings from the matches, which are far better: with the wheels' own headings, whose
// noise bends the path, it would be too short, and its end off to the side. If no match gives the heading, or if loops
// found the wheels to be very good, the wheels' heading counts and its errors are carried along.
WheelRelation MeasuredPath::wheels_between(std::size_t from, std::size_t to) const {
  Pose2 T;
  double turned_rad = 0.0;
  Matrix3 covariance;
  Matrix3 by_bias;
  Matrix3 of_turns;  // information of steps whose heading comes from a match: they move nothing behind them
  Matrix3 turns_by_bias;
  for (std::size_t i = from + 1; i <= to; ++i) {
    const MeasuredSteps& steps = path_.steps_to(i);
    const Pose2 by_wheels = corrected(steps[1].T, plain(bias_));
    const Matrix3 of_step = inverse(wheel_information_.empty() ? steps[1].information : wheel_information_[i]);
    const bool is_told = !are_wheels_good_ && inverse(steps[0].information)(2, 2) < of_step(2, 2);
    const double heading_rad = is_told ? steps[0].T.theta_rad : by_wheels.theta_rad;
    const Point2 way = Pose2{0.0, 0.0, 0.5 * (heading_rad - by_wheels.theta_rad)} * by_wheels.translation();
    const Pose2 step{way.x(), way.y(), heading_rad};
    const Matrix3 carried = adjoint_matrix(inverse(step));
    const Matrix3 change = change_with_bias(steps[1].T, bias_);
    const Matrix3 moving = Matrix3::diagonal(1.0, 1.0, is_told ? 0.0 : 1.0);
    const Matrix3 turning = Matrix3::diagonal(0.0, 0.0, is_told ? 1.0 : 0.0);
    covariance = carried * times_transposed(covariance, carried) + moving * times_transposed(of_step, moving);
    of_turns += turning * times_transposed(of_step, turning);
    by_bias = carried * by_bias + moving * change;
    turns_by_bias += turning * change;
    T = T * step;
    turned_rad += by_wheels.theta_rad;
  }
  T.theta_rad = turned_rad;
  return {.relation = {.from = from, .to = to, .T_from_to = T, .information = inverse(covariance + of_turns)},
          .by_bias = by_bias + turns_by_bias};
}

PoseRelation MeasuredPath::stretch(std::size_t from, std::size_t to, StepSource source) const {
  return rescaled(stated(from, to, source).relation, factors_[static_cast<std::size_t>(source)]);
}

std::vector<WheelRelation> MeasuredPath::all_between_places(StepSource source, Information information,
                                                            const VarianceFactor& factor) const {
  std::vector<WheelRelation> relations;
  for (std::size_t place = 1; place < places_.size(); ++place) {
    const auto [relation, by_bias] = between_places(place, source, information);
    relations.push_back({rescaled(relation, factor), by_bias});
  }
  return relations;
}

std::vector<PoseRelation> MeasuredPath::matches(Information information) const {
  std::vector<PoseRelation> relations;
  for (const WheelRelation& step : all_between_places(StepSource::kFrontEnd, information, factors_[0])) {
    relations.push_back(step.relation);
  }
  return relations;
}

std::vector<WheelRelation> MeasuredPath::wheels(double least_factor) const {
  return all_between_places(StepSource::kWheels, &MeasuredStep::information, at_least(factors_[1], least_factor));
}

// Difference of the wheels from the graph, from place to place, in units of the stated errors; distance and turn apart,
// if matches claim to be far better. If they do not, the loops decide.
VarianceFactor MeasuredPath::factor_of_wheels(const PoseGraph& graph) const {
  std::vector<double> turns;
  std::vector<double> ways;
  for (std::size_t place = 1; place < places_.size(); ++place) {
    const PoseRelation wheels = by_wheels(place).relation;
    const Matrix3 covariance = inverse(wheels.information);
    const Matrix3 of_matches = inverse(by_front_end(place).information);
    const Tangent2 off = relation_residual(wheels, graph.poses[place - 1], graph.poses[place]);
    const auto is_judged = [&](int k) { return of_matches(k, k) < kFarBetter * covariance(k, k); };
    if (is_judged(2)) turns.push_back(std::fabs(off[2]) / std::sqrt(covariance(2, 2)));
    if (is_judged(0)) ways.push_back(std::fabs(off[0]) / std::sqrt(covariance(0, 0)));
  }
  const bool are_judged = turns.size() >= kFewestOff && ways.size() >= kFewestOff;
  if (!are_judged) return variance_factor(to_relations(wheels()), graph.loops);
  return {.variance = estimate_factor(ways), .turn_variance = estimate_factor(turns), .closures = ways.size()};
}

// Factor by the difference of the matches from wheels that are known to be better.
VarianceFactor MeasuredPath::factor_beside_good_wheels() const {
  std::vector<double> turns;
  std::vector<double> ways;
  for (std::size_t place = 1; place < places_.size(); ++place) {
    const PoseRelation matches = by_front_end(place);
    const Matrix3 covariance = inverse(matches.information);
    const Tangent2 off = log_tangent(between(by_wheels(place).relation.T_from_to, matches.T_from_to));
    turns.push_back(std::fabs(off[2]) / std::sqrt(covariance(2, 2)));
    ways.push_back(std::sqrt(square(off[0]) + square(off[1])) / std::sqrt(covariance(0, 0) + covariance(1, 1)));
  }
  if (turns.size() < kFewestOff) return {};
  return {.variance = estimate_factor(ways), .turn_variance = estimate_factor(turns), .closures = ways.size()};
}

// Scans that are far apart are each matched with few others, and their errors do not average out. If a chain of the
// wheels alone then closes the loops far better than stated, its difference from the matches is the matches' error:
// loops tie nearby places and do not show it.
void MeasuredPath::weigh(const PoseGraph& graph) {
  const bool is_sparse = path_.poses.size() < kFewAPlace * places_.size();
  factors_ = {};
  are_wheels_good_ = true;
  const VarianceFactor alone = variance_factor(to_relations(wheels()), graph.loops);
  are_wheels_good_ = is_sparse && alone.variance < kVeryGood;
  VarianceFactor of_matches = at_least(variance_factor(matches(), graph.loops), kLeastOfMatches);
  if (are_wheels_good_) {
    const VarianceFactor beside = factor_beside_good_wheels();
    of_matches.variance = std::max(of_matches.variance, beside.variance);
    of_matches.turn_variance = std::max(of_matches.turn_variance, beside.turn_variance);
  }
  factors_ = {of_matches, are_wheels_good_ ? alone : factor_of_wheels(graph)};
}

}  // namespace gdtslam

#include "measured_path.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/mapping/wheels/wheel_noise.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastOfFrontEnd = 0.1;  // factor of its variance
constexpr std::size_t kBiasSteps = 12;    // keyframes of a stretch by which the wheels are judged

}  // namespace

MeasuredPath::MeasuredPath(const FrontEndPath& path, std::vector<std::size_t> places)
    : path_(path), places_(std::move(places)) {
  state_between_places();
}

void MeasuredPath::state_between_places() {
  for (std::size_t source = 0; source < kStepSources; ++source) {
    stated_[source].clear();
    for (std::size_t place = 1; place < places_.size(); ++place) {
      stated_[source].push_back(between_places(place, source, &MeasuredStep::information));
    }
  }
}

// Between two keyframes the wheels' step is a chord and a turn.
void MeasuredPath::correct_wheels(const std::vector<Pose2>& keyframes) {
  constexpr auto kWheels = static_cast<std::size_t>(StepSource::kWheels);
  std::vector<WheelStretch> stretches;
  std::size_t end_of_guess = 0;  // behind the last keyframe that lies where the wheels said
  for (std::size_t to = 0; to < keyframes.size(); ++to) {
    if (!path_.travels.empty() && !path_.travels[to].is_matched) end_of_guess = to + 1;
    if (to < end_of_guess + kBiasSteps) continue;
    const std::size_t from = to - kBiasSteps;
    const Pose2 actual = between(keyframes[from], keyframes[to]);
    WheelStretch stretch{.true_chord_m = length_of(actual), .true_turn_rad = actual.theta_rad};
    StraightenedWay way;
    for (std::size_t i = from + 1; i <= to; ++i) {
      const Pose2& step = path_.steps_to(i)[kWheels].T;
      way.add(step, between(keyframes[i - 1], keyframes[i]));
      stretch.path_m += length_of(step);
      stretch.turned_rad += std::fabs(step.theta_rad);
      stretch.forward_m += step.x_m;
      stretch.turn_rad += step.theta_rad;
    }
    stretch.chord_m = way.chord_m();
    stretches.push_back(stretch);
  }
  bias_ = estimate_bias(stretches, static_cast<double>(kBiasSteps));
  state_wheel_noise(keyframes);
  state_between_places();
}

void MeasuredPath::state_wheel_noise(const std::vector<Pose2>& keyframes) {
  if (path_.travels.empty()) return;
  constexpr auto kWheels = static_cast<std::size_t>(StepSource::kWheels);
  WheelNoise noise;
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

PoseRelation MeasuredPath::between_places(std::size_t place, std::size_t source, Information information) const {
  PoseRelation relation = stated(places_[place - 1], places_[place], source, information);
  relation.from = place - 1;
  relation.to = place;
  return relation;
}

// The covariances of the steps in between, each carried to the frame of the last.
PoseRelation MeasuredPath::stated(std::size_t from, std::size_t to, std::size_t source, Information information) const {
  Pose2 T;
  Matrix3 covariance;
  for (std::size_t i = from + 1; i <= to; ++i) {
    const MeasuredStep& step = path_.steps_to(i)[source];
    const bool is_by_wheels = source == static_cast<std::size_t>(StepSource::kWheels);
    const Pose2 T_step = is_by_wheels ? corrected(step.T, bias_) : step.T;
    const bool is_restated = is_by_wheels && !wheel_information_.empty();
    const Matrix3 carried = adjoint_matrix(inverse(T_step));
    covariance = carried * times_transposed(covariance, carried) +
                 inverse(is_restated ? wheel_information_[i] : step.*information);
    T = T * T_step;
  }
  return {.from = from, .to = to, .T_from_to = T, .information = inverse(covariance)};
}

PoseRelation MeasuredPath::stretch(std::size_t from, std::size_t to, StepSource source) const {
  const auto which = static_cast<std::size_t>(source);
  return rescaled(stated(from, to, which), factors_[which]);
}

std::vector<PoseRelation> MeasuredPath::relations() const {
  std::vector<PoseRelation> relations;
  for (std::size_t source = 0; source < kStepSources; ++source) {
    for (const PoseRelation& stated : stated_[source]) relations.push_back(rescaled(stated, factors_[source]));
  }
  return relations;
}

std::vector<PoseRelation> MeasuredPath::cautious_relations(double least_factor) const {
  std::vector<PoseRelation> relations;
  for (std::size_t source = 0; source < kStepSources; ++source) {
    VarianceFactor factor = factors_[source];
    factor.variance = std::max(factor.variance, least_factor);
    for (std::size_t place = 1; place < places_.size(); ++place) {
      relations.push_back(rescaled(between_places(place, source, &MeasuredStep::cautious), factor));
    }
  }
  return relations;
}

// The front end's own noise from scan to scan does not add up along the path, so loops tell too little of it. Where
// they find the front end far better than it says, both are believed less, in the same ratio.
void MeasuredPath::weigh(const std::vector<Loop>& loops) {
  for (std::size_t source = 0; source < kStepSources; ++source) {
    factors_[source] = variance_factor(stated_[source], loops);
  }
  const double shift = std::max(1.0, kLeastOfFrontEnd / factors_[0].variance);
  for (VarianceFactor& factor : factors_) factor.variance *= shift;
}

}  // namespace gdtslam

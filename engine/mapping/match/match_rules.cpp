#include "match_rules.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr SimplexOptions kFirstDescent{.step_cells = 2.0F, .step_rad = 0.03F};
// A gate that is not the last needs only the start accuracy of the next one.
constexpr float kLooseCells = 0.1F;
constexpr float kLooseRad = 0.001F;
constexpr double kMatchSigma_m = 0.01;  // error of a match itself
constexpr double kMatchSigma_rad = 0.005;
// First width of the slope's descent: in standard deviations of a point's predicted place, and from a sample of a
// window as a share of the wide gate.
constexpr double kErrorSigmas = 12.0;
constexpr float kSampleShare = 0.75F;
// Factor of the estimated standard deviation of the predicted heading in the prior. The wheels' error of a turn changes
// slowly: the priors of many scans in a row would all pull the same way, and bend the path.
constexpr double kTurnSigmas = 5.0;
constexpr double kWindowSigmas = 4.0;  // half of a window in standard deviations, besides the configured half width

/// A coordinate of a pose for the kernels. Values so small that a device could meet a subnormal number become 0,
/// because a device may treat such numbers as 0 (docs/numerics.md).
float coordinate(double value) {
  constexpr double kLeast = 1.0e-30;
  return std::fabs(value) < kLeast ? 0.0F : static_cast<float>(value);
}

}  // namespace

MatchRules::MatchRules(const MapperConfig& config) : config_(config) {
  SimplexOptions simplex = kFirstDescent;
  simplex.stop_cells = kLooseCells;
  simplex.stop_rad = kLooseRad;
  const GateConfig& g = config_.gate;
  for (double gate_m = g.wide_m; gate_m > g.final_m; gate_m = std::max(gate_m * g.narrowing, g.final_m)) {
    stages_.push_back({units(gate_m), simplex});
    simplex.step_cells *= 0.5F;
    simplex.step_rad *= 0.5F;
  }
  simplex.stop_cells = SimplexOptions{}.stop_cells;
  simplex.stop_rad = SimplexOptions{}.stop_rad;
  stages_.push_back({units(g.final_m), simplex});
}

PoseDescent::Params MatchRules::descent(double range_cells) const {
  PoseDescent::Params descent = descent_from_sample();
  const double error_cells = noise().sigma_m / config_.map.resolution_m + noise().sigma_rad * range_cells;
  descent.width =
      static_cast<float>(std::min(kErrorSigmas * error_cells * kFieldOne, static_cast<double>(wide_gate())));
  return descent;
}

PoseDescent::Params MatchRules::descent_from_sample() const {
  PoseDescent::Params descent;
  descent.width = kSampleShare * static_cast<float>(wide_gate());
  descent.narrowing = static_cast<float>(config_.gate.narrowing);
  descent.last_width = std::max(1.0F, static_cast<float>(final_gate()));
  return descent;
}

// No cell exceeds 16 bits, so a larger gate has no effect.
std::uint32_t MatchRules::units(double metres) const {
  constexpr double kMost = 65535.0;
  return static_cast<std::uint32_t>(std::lround(std::min(metres / config_.map.resolution_m * kFieldOne, kMost)));
}

float MatchRules::cells(double metres) const { return static_cast<float>(metres / config_.map.resolution_m); }

void MatchRules::begin(const Prediction& prediction, std::size_t points) {
  prediction_ = prediction;
  points_ = points;
  const double r = config_.map.resolution_m;
  const Pose2& T = prediction.T_map_base;
  anchor_ = map_cell_at(T.translation(), r);
  predicted_ = {coordinate(T.x_m / r - anchor_.x), coordinate(T.y_m / r - anchor_.y),
                coordinate(wrap_angle(T.theta_rad))};
  const PriorConfig& p = config_.prior;
  const double sigma_cells = noise().sigma_m / r;
  const double sigma_rad = (prediction.noise ? kTurnSigmas : 1.0) * noise().sigma_rad;
  const double weight = p.weight * kFieldOne * static_cast<double>(points);
  prior_ = {.mean_x = predicted_.x,
            .mean_y = predicted_.y,
            .mean_theta = predicted_.theta,
            .weight_xy = static_cast<float>(weight / (sigma_cells * sigma_cells)),
            .weight_theta = static_cast<float>(weight / (sigma_rad * sigma_rad)),
            .limit = static_cast<float>(std::min(weight * p.limit_sigmas * p.limit_sigmas, 1.0e9))};
}

Pose2 MatchRules::to_metres(const CellPose& pose) const {
  return pose_in_metres(pose, anchor_, config_.map.resolution_m);
}

// The estimated noise of the wheels is used as it is; without an estimate it follows from the distance travelled.
MotionNoise MatchRules::noise() const {
  const PriorConfig& p = config_.prior;
  if (!prediction_.noise) {
    return {p.sigma_m + p.sigma_per_m * prediction_.travelled_m,
            p.sigma_rad + p.sigma_per_rad * prediction_.turned_rad};
  }
  const MotionNoise& estimated = *prediction_.noise;
  return {std::sqrt(kMatchSigma_m * kMatchSigma_m + estimated.sigma_m * estimated.sigma_m),
          std::sqrt(kMatchSigma_rad * kMatchSigma_rad + estimated.sigma_rad * estimated.sigma_rad)};
}

SearchWindow MatchRules::window(double scale) const {
  const SearchConfig& s = config_.search;
  const bool is_estimated = prediction_.noise.has_value();
  if (prediction_.is_hopeless) return make_window(s.half_m, s.half_rad);
  const double more_m = is_estimated ? kWindowSigmas * noise().sigma_m : s.half_per_m * prediction_.travelled_m;
  const double more_rad = is_estimated ? kWindowSigmas * noise().sigma_rad : s.half_per_rad * prediction_.turned_rad;
  const double least_m = s.half_m + more_m;
  const double least_rad = s.half_rad + more_rad;
  double half_m = scale * least_m;
  double half_rad = scale * least_rad;
  if (is_estimated) {  // widened only as far as the robot can be
    const auto [most_m, most_rad] = reach();
    half_m = std::min(half_m, std::max(least_m, most_m));
    half_rad = std::min(half_rad, std::max(least_rad, most_rad));
  }
  return make_window(half_m, half_rad);
}

SearchWindow MatchRules::make_window(double half_m, double half_rad) const {
  const SearchConfig& s = config_.search;
  return {.centre = predicted_,
          .half_xy_cells = cells(std::min(half_m, s.max_half_m)),
          .half_theta_rad = static_cast<float>(std::min(half_rad, kPi)),
          .step_cells = cells(s.step_m),
          .step_rad = static_cast<float>(s.step_rad)};
}

MotionNoise MatchRules::reach() const {
  MotionNoise most{kReachSigmas * noise().sigma_m, kReachSigmas * noise().sigma_rad};
  if (!prediction_.otherwise) return most;
  const UncertainPose& otherwise = *prediction_.otherwise;
  const Pose2 off = between(prediction_.T_map_base, otherwise.T_map_base);
  most.sigma_m = std::max(most.sigma_m, off.translation().norm() + kReachSigmas * otherwise.noise.sigma_m);
  most.sigma_rad = std::max(most.sigma_rad, std::fabs(off.theta_rad) + kReachSigmas * otherwise.noise.sigma_rad);
  return most;
}

bool MatchRules::is_possible(const CellPose& pose) const {
  if (!prediction_.noise) return true;
  const Pose2 T_map_base = to_metres(pose);
  return is_within_reach({prediction_.T_map_base, noise()}, T_map_base) ||
         (prediction_.otherwise && is_within_reach(*prediction_.otherwise, T_map_base));
}

double MatchRules::far_m() const { return config_.doubt.suspect_sigmas * noise().sigma_m; }

double MatchRules::far_rad() const { return config_.doubt.suspect_sigmas * noise().sigma_rad; }

Evidence MatchRules::evidence(const EvidenceCounts& counts) const {
  const auto points = static_cast<double>(points_);
  return {
      .mean_cost_m = static_cast<double>(counts.sum) / (points * kFieldOne) * config_.map.resolution_m,
      .overlap = static_cast<double>(counts.near) / points,
      .contradiction = counts.known > 0 ? static_cast<double>(counts.beside) / static_cast<double>(counts.known) : 0.0};
}

bool MatchRules::is_suspect(const Evidence& evidence) const {
  return evidence.contradiction > config_.doubt.suspect_contradiction ||
         evidence.overlap < config_.doubt.suspect_overlap;
}

bool MatchRules::is_far(const CellPose& pose) const { return is_beyond(pose, far_m(), far_rad()); }

bool MatchRules::is_beyond(const CellPose& pose, double allowed_m, double allowed_rad) const {
  const auto dx = static_cast<double>(pose.x - predicted_.x) * config_.map.resolution_m;
  const auto dy = static_cast<double>(pose.y - predicted_.y) * config_.map.resolution_m;
  const auto dt = static_cast<double>(pose.theta - predicted_.theta);
  return dx * dx + dy * dy > allowed_m * allowed_m || std::fabs(dt) > allowed_rad;
}

Doubt MatchRules::find_refusal(const Evidence& evidence) const {
  if (evidence.contradiction > config_.doubt.max_contradiction) return Doubt::kContradiction;
  if (evidence.overlap < config_.doubt.min_overlap) return Doubt::kLowOverlap;
  return Doubt::kNone;
}

// Doubt about a match that is accepted: the map supports it badly, or the odometry disagrees strongly.
Doubt MatchRules::reservation_about(const CellPose& pose, const Evidence& evidence) const {
  if (is_suspect(evidence)) return Doubt::kWeakEvidence;
  const bool far = prediction_.by_odometry && is_beyond(pose, config_.doubt.report_m, config_.doubt.report_rad);
  return far ? Doubt::kFarFromPrediction : Doubt::kNone;
}

MatchResult MatchRules::judged(const CellPose& pose, const Evidence& evidence) const {
  MatchResult result;
  result.T_map_predicted = prediction_.T_map_base;
  result.mean_cost_m = evidence.mean_cost_m;
  result.overlap = evidence.overlap;
  result.contradiction = evidence.contradiction;
  result.points = static_cast<std::uint32_t>(points_);
  result.stop = evidence.stop;
  const Doubt refusal = find_refusal(evidence);
  result.accepted = refusal == Doubt::kNone;
  result.doubt = result.accepted ? reservation_about(pose, evidence) : refusal;
  result.T_map_base = result.accepted ? to_metres(pose) : prediction_.T_map_base;
  return result;
}

std::string_view to_string(Doubt doubt) {
  static constexpr std::array<std::string_view, 6> kNames{"none",          "few-points",    "low-overlap",
                                                          "contradiction", "weak-evidence", "far-from-prediction"};
  static_assert(kNames.size() == static_cast<std::size_t>(Doubt::kFarFromPrediction) + 1);
  return kNames.at(static_cast<std::size_t>(doubt));
}

std::string_view to_string(StopReason reason) {
  static constexpr std::array<std::string_view, 3> kNames{"not-run", "converged", "evaluation-limit"};
  static_assert(kNames.size() == static_cast<std::size_t>(StopReason::kEvaluationLimit) + 1);
  return kNames.at(static_cast<std::size_t>(reason));
}

}  // namespace gdtslam

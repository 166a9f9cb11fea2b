#include "gdtslam/mapping/scan_matcher.hpp"

#include <algorithm>
#include <cmath>

#include "gdtslam/compute/kernels/distance_field.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr SimplexOptions kFirstDescent{.step_cells = 2.0F, .step_rad = 0.03F};
// A gate that is not the last needs no more than the accuracy that the next one starts from.
constexpr float kLooseCells = 0.1F;
constexpr float kLooseRad = 0.001F;
constexpr SimplexOptions kCoarsePolish{.step_cells = 1.0F, .step_rad = 0.01F, .stop_cells = 0.1F, .stop_rad = 0.002F};

}  // namespace

ScanMatcher::ScanMatcher(const MapperConfig& config, Backend& backend, const GlobalField& map)
    : config_(config), map_(&map), objective_(backend, map, config.match.interpolation, config.match.cost) {}

std::uint32_t ScanMatcher::units(double metres) const {
  return static_cast<std::uint32_t>(std::lround(metres / config_.map.resolution_m * kFieldOne));
}

float ScanMatcher::cells(double metres) const { return static_cast<float>(metres / config_.map.resolution_m); }

MatchResult ScanMatcher::match(const std::vector<PointCells>& points, const Prediction& prediction, bool search) {
  const std::uint64_t before = objective_.evaluations();
  points_ = &points;
  prepare(prediction);
  Estimate best = descend(predicted_);
  const bool searched = search || (config_.search.when != SearchWhen::kNever &&
                                   (is_suspect(best.evidence) || is_far(best.pose, prediction)));
  if (searched) best = this->search(best, prediction);

  MatchResult result;
  result.T_map_predicted = prediction.T_map_base;
  result.T_map_base = objective_.to_metres(best.pose);
  result.mean_cost_m = best.evidence.mean_cost_m;
  result.overlap = best.evidence.overlap;
  result.contradiction = best.evidence.contradiction;
  result.points = static_cast<std::uint32_t>(points.size());
  result.evaluations = static_cast<std::uint32_t>(objective_.evaluations() - before);
  result.stop = best.evidence.stop;
  result.searched = searched;
  result.doubt = doubt_of(best.evidence);
  result.accepted = result.doubt == Doubt::kNone;
  if (result.accepted) {
    result.doubt = reservation_about(best, prediction);
  } else {
    result.T_map_base = prediction.T_map_base;
  }
  return result;
}

void ScanMatcher::prepare(const Prediction& prediction) {
  const double r = config_.map.resolution_m;
  objective_.set_anchor(map_cell_of(prediction.T_map_base.translation(), r));
  predicted_ = objective_.to_cells(prediction.T_map_base);
  const PriorConfig& p = config_.prior;
  const double sigma_cells = (p.sigma_m + p.sigma_per_m * prediction.travelled_m) / r;
  const double sigma_rad = p.sigma_rad + p.sigma_per_rad * prediction.turned_rad;
  const double weight = p.weight * kFieldOne * static_cast<double>(points_->size());
  objective_.set_prior({.mean = predicted_,
                        .weight_xy = static_cast<float>(weight / (sigma_cells * sigma_cells)),
                        .weight_theta = static_cast<float>(weight / (sigma_rad * sigma_rad)),
                        .limit = static_cast<float>(std::min(weight * p.limit_sigmas * p.limit_sigmas, 1.0e9))});
}

// Equation (8): points farther from the map than the gate do not count, but a share of them always does.
void ScanMatcher::keep_points_within(std::uint32_t gate, const CellPose& pose) {
  objective_.residuals(pose, *points_, values_);
  kept_.clear();
  for (std::size_t i = 0; i < points_->size(); ++i) {
    if (values_[i] <= gate) kept_.push_back((*points_)[i]);
  }
  const bool enough =
      static_cast<double>(kept_.size()) >= config_.gate.min_share * static_cast<double>(points_->size());
  objective_.set_points(enough ? kept_ : *points_);
}

// Equations (8) and (4) in turn, the gate narrowing around the best pose so far.
ScanMatcher::Estimate ScanMatcher::descend(const CellPose& start) {
  CellPose pose = start;
  SimplexOptions simplex = kFirstDescent;
  StopReason stop = StopReason::kNotRun;
  const GateConfig& g = config_.gate;
  objective_.set_cap(map_->cap());
  for (double gate_m = g.wide_m;; gate_m = std::max(gate_m * g.narrowing, g.final_m)) {
    const bool last = gate_m <= g.final_m;
    if (!last) {
      simplex.stop_cells = kLooseCells;
      simplex.stop_rad = kLooseRad;
    } else {
      simplex.stop_cells = SimplexOptions{}.stop_cells;
      simplex.stop_rad = SimplexOptions{}.stop_rad;
    }
    keep_points_within(units(gate_m), pose);
    const SimplexResult found = minimise_simplex(objective_, pose, simplex);
    pose = found.pose;
    stop = found.stop;
    simplex.step_cells *= 0.5F;
    simplex.step_rad *= 0.5F;
    if (last) break;
  }
  Estimate estimate{pose, judge(pose)};
  estimate.evidence.stop = stop;
  return estimate;
}

ScanMatcher::Evidence ScanMatcher::judge(const CellPose& pose) {
  objective_.residuals(pose, *points_, values_);
  const std::uint32_t gate = units(config_.gate.final_m);
  const std::uint32_t wide = units(config_.gate.wide_m);
  std::uint64_t sum = 0;
  std::size_t near = 0;
  std::size_t beside = 0;
  std::size_t known = 0;
  for (const std::uint16_t value : values_) {
    sum += std::min<std::uint32_t>(value, wide);
    near += value <= gate ? 1U : 0U;
    known += value < map_->cap() ? 1U : 0U;
    beside += value > 2 * gate && value < map_->cap() ? 1U : 0U;
  }
  const auto count = static_cast<double>(points_->size());
  return {.mean_cost_m = static_cast<double>(sum) / (count * kFieldOne) * config_.map.resolution_m,
          .overlap = static_cast<double>(near) / count,
          .contradiction = known > 0 ? static_cast<double>(beside) / static_cast<double>(known) : 0.0};
}

bool ScanMatcher::is_suspect(const Evidence& evidence) const {
  return evidence.contradiction > config_.doubt.suspect_contradiction ||
         evidence.overlap < config_.doubt.suspect_overlap;
}

bool ScanMatcher::is_far(const CellPose& pose, const Prediction& prediction) const {
  const double sigmas = config_.doubt.suspect_sigmas;
  const PriorConfig& p = config_.prior;
  return is_beyond(pose, sigmas * (p.sigma_m + p.sigma_per_m * prediction.travelled_m),
                   sigmas * (p.sigma_rad + p.sigma_per_rad * prediction.turned_rad));
}

// What is to be said of a match that stands: the map supports it badly, or the odometry says something quite different.
Doubt ScanMatcher::reservation_about(const Estimate& estimate, const Prediction& prediction) const {
  if (is_suspect(estimate.evidence)) return Doubt::kWeakEvidence;
  const bool far = prediction.by_odometry && is_beyond(estimate.pose, config_.doubt.report_m, config_.doubt.report_rad);
  return far ? Doubt::kFarFromPrediction : Doubt::kNone;
}

bool ScanMatcher::is_beyond(const CellPose& pose, double allowed_m, double allowed_rad) const {
  const auto dx = static_cast<double>(pose.x - predicted_.x) * config_.map.resolution_m;
  const auto dy = static_cast<double>(pose.y - predicted_.y) * config_.map.resolution_m;
  const auto dt = static_cast<double>(pose.theta - predicted_.theta);
  return dx * dx + dy * dy > allowed_m * allowed_m || std::fabs(dt) > allowed_rad;
}

Doubt ScanMatcher::doubt_of(const Evidence& evidence) const {
  if (evidence.contradiction > config_.doubt.max_contradiction) return Doubt::kContradiction;
  if (evidence.overlap < config_.doubt.min_overlap) return Doubt::kLowOverlap;
  return Doubt::kNone;
}

// Points over cells that the map does not know say nothing of where the robot is, but a pose that pulls them back over
// known walls looks better for it; so they do not vote, unless the local estimate is so suspect that it cannot tell
// which they are.
void ScanMatcher::choose_voters(const Estimate& local) {
  voters_.clear();
  const bool trusted = !is_suspect(local.evidence);
  objective_.residuals(local.pose, *points_, values_);
  const std::uint32_t gate = units(config_.gate.wide_m);
  for (std::size_t i = 0; i < points_->size(); ++i) {
    if (!trusted || values_[i] < std::min<std::uint32_t>(gate, map_->cap())) voters_.push_back((*points_)[i]);
  }
  const auto most = static_cast<std::size_t>(config_.search.max_points);
  const std::size_t every = (voters_.size() + most - 1) / most;
  thinned_.clear();
  for (std::size_t i = every / 2; i < voters_.size(); i += every) thinned_.push_back(voters_[i]);
}

std::uint32_t ScanMatcher::cost_to_voters(const CellPose& pose) {
  objective_.set_points(voters_);
  objective_.set_cap(units(config_.gate.wide_m));
  return objective_.evaluate(pose);
}

SearchWindow ScanMatcher::window_around(const Prediction& prediction, double scale) const {
  const SearchConfig& s = config_.search;
  const double half_m = scale * (s.half_m + s.half_per_m * prediction.travelled_m);
  const double half_rad = scale * (s.half_rad + s.half_per_rad * prediction.turned_rad);
  return {.centre = predicted_,
          .half_xy_cells = cells(std::min(half_m, s.max_half_m)),
          .half_theta_rad = static_cast<float>(std::min(half_rad, kPi)),
          .step_cells = cells(s.step_m),
          .step_rad = static_cast<float>(s.step_rad)};
}

// A window around the prediction, twice as large each time as long as what it finds is suspect or lies on its edge.
ScanMatcher::Estimate ScanMatcher::search(const Estimate& local, const Prediction& prediction) {
  Estimate best = local;
  choose_voters(local);
  std::uint32_t best_cost = cost_to_voters(local.pose);
  for (std::int32_t attempt = 0; attempt < config_.search.attempts; ++attempt) {
    objective_.set_points(thinned_);
    objective_.set_cap(units(config_.gate.wide_m));
    const ExhaustiveResult found = search_window(objective_, window_around(prediction, std::ldexp(1.0, attempt)),
                                                 static_cast<std::uint32_t>(config_.search.starts), kCoarsePolish);
    const Estimate polished = descend(found.pose);
    std::uint32_t cost = cost_to_voters(polished.pose);
    if (prediction.by_odometry && is_far(polished.pose, prediction) && !is_far(local.pose, prediction)) {
      const double factor = 1.0 / config_.doubt.leap_gain;
      cost = static_cast<std::uint32_t>(std::min(cost * factor, 4.0e9));
    }
    const bool taken = cost < best_cost;
    if (taken) {
      best = polished;
      best_cost = cost;
    }
    if (!is_suspect(best.evidence) && !(taken && found.at_edge)) break;
  }
  return best;
}

}  // namespace gdtslam

#include "scan_matcher.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "descents.hpp"
#include "engine/mapping/certified/crop.hpp"
#include "matchers.hpp"

namespace gdtslam {
namespace {

constexpr SimplexOptions kCoarsePolish{.step_cells = 1.0F, .step_rad = 0.01F, .stop_cells = 0.1F, .stop_rad = 0.002F};

}  // namespace

ScanMatcher::ScanMatcher(const MapperConfig& config, const GlobalField& map)
    : matcher_(&matcher_info(config.match.matcher)),
      optimizer_(config.optimizer),
      gate_(config.gate),
      search_(config.search),
      leap_gain_(config.doubt.leap_gain),
      map_(&map),
      rules_(config),
      objective_(map, config.match.interpolation, config.match.cost),
      isa_(map.backend().host_isa()) {
  if (matcher_->proves_windows) crop_ = std::make_unique<CertifiedCrop>(rules_.wide_gate());
}

ScanMatcher::~ScanMatcher() = default;

MatchResult ScanMatcher::match(std::span<const PointCells> points, const Prediction& prediction, bool must_search) {
  assert(map_->box().empty() || !map_->memory().empty());  // it lives where the host sees it
  points_ = points;
  by_odometry_ = prediction.by_odometry;
  rules_.begin(prediction, points.size());
  objective_.set_anchor(rules_.anchor());
  objective_.set_prior(rules_.prior());
  const std::uint64_t before = objective_.evaluations();
  attempts_ = 0;
  proven_gap_m_.reset();
  proof_evaluations_ = 0;
  Estimate best = descend(rules_.predicted());
  if (must_search || (search_.when != SearchWhen::kNever && rules_.may_search() &&
                      (rules_.is_suspect(best.evidence) || rules_.is_far(best.pose)))) {
    best = search(best);
  }
  MatchResult result = rules_.judged(best.pose, best.evidence);
  result.evaluations = static_cast<std::uint32_t>(objective_.evaluations() - before + proof_evaluations_);
  result.proven_gap_m = proven_gap_m_;
  result.attempts = attempts_;
  return result;
}

// Equation (8): points farther from the map than the gate do not count, but a share of them always does.
void ScanMatcher::keep_points_within(std::uint32_t gate, const CellPose& pose) {
  objective_.residuals(pose, points_, values_);
  kept_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (values_[i] <= gate) kept_.push_back(points_[i]);
  }
  const bool enough = static_cast<double>(kept_.size()) >= gate_.min_share * static_cast<double>(points_.size());
  objective_.set_points(enough ? std::span<const PointCells>(kept_) : points_);
}

LocalMinimum ScanMatcher::minimise(const CellPose& start, const DescentStage& stage) {
  return matcher_->descend(objective_, start, stage.simplex, optimizer_);
}

// Near the end the points scatter around the walls, and squares average that better than the sum of distances does.
LocalMinimum ScanMatcher::refine(const CellPose& pose) {
  const DescentStage& last = rules_.stages().back();
  keep_points_within(last.gate, pose);
  return minimise_gauss_newton(objective_, pose,
                               {.stop_cells = last.simplex.stop_cells, .stop_rad = last.simplex.stop_rad});
}

// Equations (8) and (4) in turn, the gate narrowing around the best pose so far.
ScanMatcher::Estimate ScanMatcher::descend(const CellPose& start) {
  CellPose pose = start;
  StopReason stop = StopReason::kNotRun;
  objective_.set_cap(map_->cap());
  for (const DescentStage& stage : rules_.stages()) {
    keep_points_within(stage.gate, pose);
    const LocalMinimum found = minimise(pose, stage);
    pose = found.pose;
    stop = found.stop;
  }
  if (matcher_->is_refined) {
    const LocalMinimum refined = refine(pose);
    pose = refined.pose;
    stop = refined.stop;
  }
  Estimate estimate{pose, judge(pose)};
  estimate.evidence.stop = stop;
  return estimate;
}

Evidence ScanMatcher::judge(const CellPose& pose) {
  objective_.residuals(pose, points_, values_);
  const std::uint32_t gate = rules_.final_gate();
  const std::uint32_t wide = rules_.wide_gate();
  const std::uint16_t cap = map_->cap();
  EvidenceCounts counts;
  for (const std::uint16_t value : values_) {
    counts.sum += std::min<std::uint32_t>(value, wide);
    counts.near += value <= gate ? 1U : 0U;
    counts.known += value < cap ? 1U : 0U;
    counts.beside += value > 2 * gate && value < cap ? 1U : 0U;
  }
  return rules_.evidence(counts);
}

// Points over cells that the map does not know say nothing of where the robot is, but a pose that pulls them back over
// known walls looks better for it; so they do not vote, unless the local estimate is so suspect that it cannot tell
// which they are.
void ScanMatcher::choose_voters(const Estimate& local) {
  voters_.clear();
  const bool trusted = !rules_.is_suspect(local.evidence);
  objective_.residuals(local.pose, points_, values_);
  const std::uint32_t limit = std::min<std::uint32_t>(rules_.wide_gate(), map_->cap());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!trusted || values_[i] < limit) voters_.push_back(points_[i]);
  }
  thin(voters_, static_cast<std::size_t>(search_.max_points), thinned_);
}

std::uint32_t ScanMatcher::cost_to_voters(const CellPose& pose) {
  objective_.set_points(voters_);
  objective_.set_cap(rules_.wide_gate());
  return objective_.evaluate(pose);
}

ExhaustiveResult ScanMatcher::find_in(const SearchWindow& window) {
  if (crop_ != nullptr && !voters_.empty() && voters_.size() <= kMostCertifiedPoints) return prove_in(window);
  objective_.set_points(thinned_);
  objective_.set_cap(rules_.wide_gate());
  return search_window(objective_, window, static_cast<std::uint32_t>(search_.starts), kCoarsePolish);
}

// The best pose of a window for all voters, up to the gap; by the cost that search() compares poses by.
ExhaustiveResult ScanMatcher::prove_in(const SearchWindow& window) {
  const double resolution_m = map_->geometry().resolution_m;
  const double half_m = static_cast<double>(window.half_xy_cells) * resolution_m;
  const PoseWindow poses{.centre = objective_.to_metres(window.centre),
                         .half_x_m = half_m,
                         .half_y_m = half_m,
                         .half_theta_rad = static_cast<double>(window.half_theta_rad)};
  const PriorParams& prior = rules_.prior();
  CertifiedOptions options;
  options.gap_m = search_.gap_m;
  options.max_boxes = std::uint64_t{1000} * static_cast<std::uint64_t>(search_.max_kiloboxes);
  options.counts_window = false;
  options.starts = {poses.centre};
  options.prior = WindowPrior{.mean = objective_.to_metres(rules_.predicted()),
                              .weight_xy = prior.weight_xy,
                              .weight_theta = prior.weight_theta,
                              .limit = prior.limit};
  const CertifiedMap& map = crop_->of(*map_, reached_from(poses, voters_, resolution_m), isa_);
  const CertifiedResult found = find_pose(map, voters_, poses, options);
  proven_gap_m_ = found.gap_m;
  proof_evaluations_ += found.boxes + found.evaluations;
  ExhaustiveResult result{
      .pose = objective_.to_cells(found.T_map_base), .cost = found.cost, .evaluations = 0, .at_edge = false};
  result.at_edge = window.has_at_edge(result.pose);
  return result;
}

// A window around the prediction, twice as large each time as long as what it finds is suspect or lies on its edge.
ScanMatcher::Estimate ScanMatcher::search(const Estimate& local) {
  Estimate best = local;
  choose_voters(local);
  std::uint32_t best_cost = cost_to_voters(local.pose);
  for (; attempts_ < static_cast<std::uint32_t>(search_.attempts);) {
    const ExhaustiveResult found = find_in(rules_.window(std::ldexp(1.0, static_cast<int>(attempts_))));
    ++attempts_;
    const Estimate polished = descend(found.pose);
    std::uint32_t cost = cost_to_voters(polished.pose);
    if (by_odometry_ && rules_.is_far(polished.pose) && !rules_.is_far(local.pose)) {
      const double factor = 1.0 / leap_gain_;
      cost = static_cast<std::uint32_t>(std::min(cost * factor, 4.0e9));
    }
    const bool taken = cost < best_cost && rules_.is_possible(polished.pose);
    if (taken) {
      best = polished;
      best_cost = cost;
    }
    if (!rules_.is_suspect(best.evidence) && !(taken && found.at_edge)) break;
  }
  return best;
}

}  // namespace gdtslam

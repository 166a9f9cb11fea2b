#include "window_matcher.hpp"

#include <cmath>
#include <string>

#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"
#include "engine/mapping/map/device_memory.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

std::uint32_t q16(double share) { return static_cast<std::uint32_t>(std::lround(share * 65536.0)); }

CellPose to_cell_pose(const MatchVerdict& verdict) { return {verdict.x, verdict.y, verdict.theta}; }

// If a device has no room for a window, the step fails like a failed device: the CPU has room.
void require_room(std::uint32_t samples, const DeviceInfo& device) {
  const std::size_t bytes = std::size_t{samples} * sizeof(PoseCandidate);
  if (bytes <= device.max_buffer_bytes) return;
  throw DeviceError(device.name, "allocate",
                    "no buffer for a search window: its " + std::to_string(samples) + " poses are " +
                        std::to_string(bytes) + " bytes, the largest allowed is " +
                        std::to_string(device.max_buffer_bytes) +
                        "; raise search.step and search.step_angle or lower search.max_half_width");
}

}  // namespace

WindowMatcher::WindowMatcher(const MapperConfig& config, const GlobalField& map)
    : match_(config.match),
      search_(config.search),
      doubt_(config.doubt),
      backend_(&map.backend()),
      map_(&map),
      rules_(config),
      picks_(backend_->allocate(std::size_t{SmallestValues::kMost} * 2 * sizeof(std::uint32_t))),
      poses_(backend_->allocate(std::size_t{SmallestValues::kMost + 1} * sizeof(PolishedPose))),
      verdict_(backend_->allocate(sizeof(MatchVerdict))) {}

MatchResult WindowMatcher::match(std::span<const PointCells> points, const Prediction& prediction, bool /*search*/) {
  by_odometry_ = prediction.by_odometry;
  points_ = static_cast<std::uint32_t>(points.size());
  rules_.begin(prediction, points.size());
  // Sums of integers do not depend on the order, so one upload serves both: a launch reads a given number of points.
  thinned_ = static_cast<std::uint32_t>(
      put_thinned_first(points, static_cast<std::size_t>(search_.max_points), ordered_points_));
  reserve_on(*backend_, point_buffer_, points.size_bytes());
  backend_->upload(point_buffer_, std::as_bytes(std::span(ordered_points_)));
  attempts_ = 0;
  launch(rules_.window(1.0));
  MatchVerdict best = wait();
  Evidence evidence = to_evidence(best);
  std::uint64_t evaluations = samples_ + best.evaluations;
  bool taken = best.chosen != 0;
  SearchWindow before = window_;
  while ((rules_.is_suspect(evidence) || (taken && window_.has_at_edge(to_cell_pose(best)))) && launch_wider()) {
    const MatchVerdict found = wait();
    evaluations += samples_ + found.evaluations;
    taken = is_better(found, best, before);
    before = window_;
    if (!taken) continue;
    best = found;
    evidence = to_evidence(found);
  }
  MatchResult result = rules_.judged(to_cell_pose(best), evidence);
  result.evaluations = static_cast<std::uint32_t>(evaluations);
  result.attempts = attempts_;
  return result;
}

// Far away some place always looks alike. So a pose that only the wider window holds must be clearly better, as any
// pose that the odometry contradicts; CSAIL at half its rate is lost without this rule where its odometry fails.
bool WindowMatcher::is_better(const MatchVerdict& found, const MatchVerdict& best, const SearchWindow& before) const {
  if (!rules_.is_possible(to_cell_pose(found))) return false;
  const double share = by_odometry_ && !before.holds(to_cell_pose(found)) ? doubt_.leap_gain : 1.0;
  return static_cast<double>(found.cost) < share * static_cast<double>(best.cost);
}

// Launches a window twice as large, if another attempt is allowed and it would be larger at all.
bool WindowMatcher::launch_wider() {
  if (!rules_.may_search() || attempts_ >= static_cast<std::uint32_t>(search_.attempts)) return false;
  const SearchWindow wider = rules_.window(std::ldexp(1.0, static_cast<int>(attempts_)));
  if (wider.half_xy_cells <= window_.half_xy_cells && wider.half_theta_rad <= window_.half_theta_rad) return false;
  launch(wider);
  return true;
}

// One submission: from the points to the verdict.
void WindowMatcher::launch(const SearchWindow& window) {
  window_ = window;
  samples_ = window_.count_xy() * window_.count_xy() * window_.count_theta();
  ++attempts_;
  require_room(samples_, backend_->device());
  launch_lattice();
  launch_starts();
  launch_verdict();
}

// Evaluates the samples of the window with a share of the points, and finds the best minima.
void WindowMatcher::launch_lattice() {
  reserve_on(*backend_, candidates_, std::size_t{samples_} * sizeof(PoseCandidate));
  reserve_on(*backend_, costs_, std::size_t{samples_} * sizeof(std::uint32_t));
  reserve_on(*backend_, minima_, std::size_t{samples_} * sizeof(std::uint32_t));
  const PoseLattice::Params lattice = lattice_params();
  run<PoseLattice>(*backend_, lattice, {samples_, 1, 1}, candidates_);
  run<PoseCost>(*backend_, cost_params(thinned_, rules_.wide_gate()), {samples_, 1, 1}, map_->buffer(), point_buffer_,
                candidates_, costs_);
  run<LatticeMinima>(*backend_, {.count_xy = lattice.count_xy, .count_theta = lattice.count_theta}, {samples_, 1, 1},
                     costs_, minima_);
  run<SmallestValues>(*backend_, {.count = samples_, .wanted = pose_count() - 1}, {1, 1, 1}, minima_, picks_);
}

// Starts: the prediction and each of those minima.
void WindowMatcher::launch_starts() {
  const CellPose& predicted = rules_.predicted();
  run<PoseStarts>(*backend_,
                  {.x = predicted.x, .y = predicted.y, .theta = predicted.theta, .candidate_count = samples_},
                  {pose_count(), 1, 1}, candidates_, picks_, poses_);
}

void WindowMatcher::launch_verdict() {
  launch_descents();
  launch_choice();
  pending_ = backend_->start_download(verdict_, sizeof(MatchVerdict));
  backend_->flush();
}

// Descends from all starts, the gate narrowing.
void WindowMatcher::launch_descents() {
  const PriorParams& prior = rules_.prior();
  for (const DescentStage& stage : rules_.stages()) {
    run<PoseSimplex>(*backend_,
                     {.cost = cost_params(points_, stage.gate),
                      .prior = prior,
                      .step_cells = stage.simplex.step_cells,
                      .step_rad = stage.simplex.step_rad,
                      .stop_cells = stage.simplex.stop_cells,
                      .stop_rad = stage.simplex.stop_rad,
                      .max_evaluations = stage.simplex.max_evaluations},
                     {pose_count(), 1, 1}, map_->buffer(), point_buffer_, poses_);
  }
}

void WindowMatcher::launch_choice() {
  const double far_cells = rules_.far_m() / map_->geometry().resolution_m;
  run<ChoosePose>(*backend_,
                  {.cost = cost_params(points_, rules_.wide_gate()),
                   .prior = rules_.prior(),
                   .pose_count = pose_count(),
                   .map_cap = map_->cap(),
                   .gate = rules_.final_gate(),
                   .contradiction_q16 = q16(doubt_.suspect_contradiction),
                   .overlap_q16 = q16(doubt_.suspect_overlap),
                   .leap_q8 = by_odometry_ ? static_cast<std::uint32_t>(std::lround(256.0 / doubt_.leap_gain)) : 0U,
                   .far_sq_cells = static_cast<float>(far_cells * far_cells),
                   .far_rad = static_cast<float>(rules_.far_rad())},
                  {1, 1, 1}, map_->buffer(), point_buffer_, poses_, verdict_);
}

MatchVerdict WindowMatcher::wait() {
  MatchVerdict verdict;
  backend_->finish_download(pending_, std::as_writable_bytes(std::span(&verdict, 1)));
  return verdict;
}

Evidence WindowMatcher::to_evidence(const MatchVerdict& verdict) const {
  Evidence evidence =
      rules_.evidence({.sum = verdict.sum, .near = verdict.near, .beside = verdict.beside, .known = verdict.known});
  evidence.stop = stop_reason(verdict.stop);
  return evidence;
}

PoseLattice::Params WindowMatcher::lattice_params() const {
  return {.centre_x = window_.centre.x,
          .centre_y = window_.centre.y,
          .centre_theta = window_.centre.theta,
          .step_cells = window_.step_cells,
          .step_rad = window_.step_rad,
          .count_xy = window_.count_xy(),
          .count_theta = window_.count_theta(),
          .prior = prior_of_share(static_cast<double>(thinned_) / points_)};
}

PoseCost::Params WindowMatcher::cost_params(std::uint32_t points, std::uint32_t cap) const {
  return pose_cost_params(*map_, rules_.anchor(), points, cap, match_.interpolation, match_.cost);
}

// The prior for a share of the points: its weight relative to one point stays the same.
PriorParams WindowMatcher::prior_of_share(double share) const {
  PriorParams prior = rules_.prior();
  const auto part = static_cast<float>(share);
  prior.weight_xy *= part;
  prior.weight_theta *= part;
  prior.limit *= part;
  return prior;
}

}  // namespace gdtslam

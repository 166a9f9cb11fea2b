// The poses of a search: their costs, the ends of descents from them, and the loop that opens boxes until the proof is
// complete.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/core/files/interruption.hpp"
#include "engine/mapping/cost/objective.hpp"
#include "gdtslam/core/angle.hpp"
#include "search.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kBatch = 16;            // boxes taken at once
constexpr std::size_t kMostOpen = 1U << 23U;  // each takes 32 bytes
constexpr float kTriedHalfWidth = 2.1F;       // centres of boxes up to this half width are tried as poses
constexpr float kPolishedHalfWidth = 0.9F;    // centres of boxes of at least this half width start descents,
constexpr std::uint32_t kWorthPolishing = 4;  // unless they cost more than the best by more than a quarter of it

bool comes_later(const OpenBox& a, const OpenBox& b) {
  return a.bound != b.bound ? a.bound > b.bound : a.order < b.order;
}

}  // namespace

CellPose CertifiedSearch::to_cells(const Pose2& pose) const {
  const double resolution_m = map_.field().resolution_m;
  const double middle = static_cast<double>(centre_.theta);
  return {static_cast<float>(pose.x_m / resolution_m - anchor_.x),
          static_cast<float>(pose.y_m / resolution_m - anchor_.y),
          static_cast<float>(middle + wrap_angle(pose.theta_rad - middle))};
}

// The nearest value within a narrow window, up to float32.
CellPose CertifiedSearch::in_narrow_window(CellPose pose) const {
  const double resolution_m = map_.field().resolution_m;
  const CellPose middle = to_cells(window_.centre);
  const auto moved = [](float value, float centre, double half) {
    return std::clamp(value, centre - static_cast<float>(half), centre + static_cast<float>(half));
  };
  if (is_narrow_x_) pose.x = moved(pose.x, middle.x, window_.half_x_m / resolution_m);
  if (is_narrow_y_) pose.y = moved(pose.y, middle.y, window_.half_y_m / resolution_m);
  if (is_narrow_theta_) pose.theta = moved(pose.theta, middle.theta, window_.half_theta_rad);
  return pose;
}

// A narrow window may need more digits than float32 has; they are added here.
Pose2 CertifiedSearch::to_metres(const CellPose& pose) const {
  const Pose2& centre = window_.centre;
  const auto within = [](double off, double middle, double half) {
    const double most = std::max(0.0, half - 1.0e-15 * (std::fabs(middle) + 8.0));  // rounding on either side
    return middle + std::clamp(off, -most, most);
  };
  Pose2 T = pose_in_metres(pose, anchor_, map_.field().resolution_m);
  if (is_narrow_x_) T.x_m = within(T.x_m - centre.x_m, centre.x_m, window_.half_x_m);
  if (is_narrow_y_) T.y_m = within(T.y_m - centre.y_m, centre.y_m, window_.half_y_m);
  if (is_narrow_theta_) {
    T.theta_rad = within(wrap_angle(T.theta_rad - centre.theta_rad), centre.theta_rad, window_.half_theta_rad);
    T.theta_rad = wrap_angle(T.theta_rad);
  }
  return T;
}

bool CertifiedSearch::is_allowed(const CellPose& pose) const {
  const Pose2 T = to_metres(pose);
  return window_.holds(T) && std::none_of(options_.excluded.begin(), options_.excluded.end(),
                                          [&](const ExcludedPoses& excluded) { return excluded.hold(T); });
}

// The same arithmetic as PriorParams.
std::uint32_t CertifiedSearch::evaluate_cost(const CellPose& pose) {
  const float dx = pose.x - prior_.mean_x;
  const float dy = pose.y - prior_.mean_y;
  const float dt = pose.theta - prior_.mean_theta;
  const auto limited = [this](float cost) { return cost < prior_.limit ? cost : prior_.limit; };
  const auto prior = static_cast<std::uint32_t>(limited((dx * dx + dy * dy) * prior_.weight_xy) +
                                                limited((dt * dt) * prior_.weight_theta));
  const PoseCandidate candidate{pose.x, pose.y, pose.theta, prior};
  std::uint32_t cost = 0;
  pose_cost_host(map_.isa(), cost_params_, map_.field().cells, points_.data(), &candidate, 1, &cost);
  ++evaluations_;
  return cost;
}

void CertifiedSearch::offer(const CellPose& pose, std::uint32_t cost) {
  if (cost >= best_cost_ || !is_allowed(pose)) return;
  best_cost_ = cost;
  best_ = pose;
}

void CertifiedSearch::polish(const CellPose& start, float step_cells) {
  PoseSimplex::Params walk;
  walk.cost = cost_params_;
  walk.prior = prior_;
  walk.step_cells = step_cells;
  walk.step_rad = step_cells / reference_;
  PolishedPose pose{start.x, start.y, start.theta};
  pose_simplex_host(map_.isa(), walk, map_.field().cells, points_.data(), &pose, 1);
  evaluations_ += pose.evaluations;
  const bool is_narrow = is_narrow_x_ || is_narrow_y_ || is_narrow_theta_;
  const CellPose end = in_narrow_window({pose.x, pose.y, pose.theta});
  offer(end, is_narrow ? evaluate_cost(end) : pose.cost);
}

void CertifiedSearch::try_starts() {
  for (const Pose2& start : options_.starts) {
    const CellPose pose = in_narrow_window(to_cells(start));
    offer(pose, evaluate_cost(pose));
    polish(pose, 1.0F);
  }
}

// Tries the best box of a batch that is small enough for its centre to be useful.
void CertifiedSearch::try_centres(std::span<const OpenBox> boxes) {
  for (const OpenBox& box : boxes) {
    const float w = half_width(box.level);
    if (w > kTriedHalfWidth) continue;
    const CellPose pose =
        in_narrow_window({std::clamp(box.centre.x, centre_.x - half_x_, centre_.x + half_x_),
                          std::clamp(box.centre.y, centre_.y - half_y_, centre_.y + half_y_), box.centre.theta});
    const std::uint32_t cost = evaluate_cost(pose);
    const bool worth =
        cost < best_cost_ || (w > kPolishedHalfWidth && cost - best_cost_ < best_cost_ / kWorthPolishing);
    offer(pose, cost);
    if (worth) polish(pose, std::max(w, 0.25F));
    return;
  }
}

std::uint32_t CertifiedSearch::enough() const {
  if (best_cost_ == kNoCost) return options_.wanted_bound;
  return std::min(best_cost_ > gap_ ? best_cost_ - gap_ : 0, options_.wanted_bound);
}

std::optional<CertifiedStop> CertifiedSearch::limit_reached() const {
  if (boxes_ - uncounted_ >= options_.max_boxes || open_.size() >= kMostOpen) return CertifiedStop::kBoxLimit;
  const bool is_unbounded = options_.max_boxes == std::numeric_limits<std::uint64_t>::max();
  if (is_unbounded && is_asked_to_end()) return CertifiedStop::kTimeLimit;
  if (options_.max_seconds == std::numeric_limits<double>::infinity()) return std::nullopt;
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - began_;
  if (spent.count() >= options_.max_seconds) return CertifiedStop::kTimeLimit;
  return std::nullopt;
}

// Opens boxes, best bound first, until no remaining box can be better by more than the gap.
void CertifiedSearch::work_through() {
  std::make_heap(open_.begin(), open_.end(), comes_later);
  std::vector<OpenBox> batch;
  while (!open_.empty() && open_.front().bound < enough()) {
    if (const std::optional<CertifiedStop> limit = limit_reached()) {
      stop_ = *limit;
      return;
    }
    batch.clear();
    while (!open_.empty() && batch.size() < kBatch && open_.front().bound < enough()) {
      std::pop_heap(open_.begin(), open_.end(), comes_later);
      batch.push_back(open_.back());
      open_.pop_back();
    }
    try_centres(batch);
    for (const OpenBox& box : batch) {
      const std::size_t before = open_.size();
      expand(box);
      for (std::size_t end = before + 1; end <= open_.size(); ++end) {
        std::push_heap(open_.begin(), open_.begin() + static_cast<std::ptrdiff_t>(end), comes_later);
      }
    }
  }
  const bool is_wanted = closed_bound_ != kNoCost && (best_cost_ == kNoCost || best_cost_ - enough() > gap_);
  stop_ = is_wanted ? CertifiedStop::kBoundReached : CertifiedStop::kGapReached;
  if (at_resolution_ && closed_bound_ < enough()) stop_ = CertifiedStop::kResolution;
}

CertifiedResult CertifiedSearch::run() {
  try_starts();
  open_window();
  if (!options_.counts_window) uncounted_ = boxes_;
  work_through();
  return result();
}

CertifiedResult CertifiedSearch::result() const {
  CertifiedResult result;
  const std::uint32_t open_bound = open_.empty() ? kNoCost : open_.front().bound;
  result.bound = std::min({closed_bound_, open_bound, best_cost_});
  result.boxes = boxes_;
  result.evaluations = evaluations_;
  result.stop = best_cost_ == kNoCost && stop_ == CertifiedStop::kGapReached ? CertifiedStop::kNothingAllowed : stop_;
  const double unit_m = map_.field().resolution_m / 256.0 / static_cast<double>(points_.size());
  result.mean_bound_m = result.bound * unit_m;
  result.cost = best_cost_;
  if (best_cost_ == kNoCost) {
    result.T_map_base = window_.centre;
    result.mean_cost_m = result.gap_m = std::numeric_limits<double>::infinity();
    return result;
  }
  result.T_map_base = to_metres(best_);
  result.mean_cost_m = best_cost_ * unit_m;
  result.gap_m = (best_cost_ - result.bound) * unit_m;
  return result;
}

}  // namespace gdtslam

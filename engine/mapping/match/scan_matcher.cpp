#include "scan_matcher.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "descents.hpp"
#include "engine/core/elementary.hpp"
#include "engine/mapping/certified/field.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {
namespace {

/// Part of a map that a search needs.
struct ReachedCells {
  CellBox box;  ///< holds every cell that a point may fall into, in map cells
  CertifiedMap::Windows windows = CertifiedMap::kSmallWindows;
};

constexpr std::int32_t kEdge = 4;  // cells: patches and bilinear neighbours
// Cells: parts begin kRoom after a multiple of kBoundAlignment and end kRoom before one. With the margin that
// BoundFields adds for its squares they begin and end on a multiple.
constexpr std::int32_t kRoom = 16;
// In smaller windows wider boxes and fields of minorants save less than their preparation costs.
constexpr double kNear_m = 0.8;
constexpr double kNear_rad = 0.5;

CellBox whole_grains(const CellBox& box) {
  const auto begin = [](std::int32_t cell) { return aligned_down(cell - kEdge - kRoom) + kRoom; };
  const auto end = [](std::int32_t cell) { return -aligned_down(-(cell + kEdge + kRoom)) - kRoom; };
  return {{begin(box.min.x), begin(box.min.y)}, {end(box.end.x), end(box.end.y)}};
}

// Copies the cells of the box up to the cap; outside the map and in the two outermost rows and columns: the cap.
void copy_cells(const GlobalField& map, const CellBox& box, std::uint16_t cap, std::vector<std::uint16_t>& cells) {
  const auto width = static_cast<std::size_t>(box.width());
  cells.assign(width * static_cast<std::size_t>(box.height()), cap);
  for (std::int32_t y = box.min.y + 2; y < box.end.y - 2; ++y) {
    const auto row = std::span(cells).subspan(static_cast<std::size_t>(y - box.min.y) * width + 2, width - 4);
    map.read_row({box.min.x + 2, y}, row);
    for (std::uint16_t& cell : row) cell = std::min(cell, cap);
  }
}

/// The cells that points fall into from any pose of the window, and the fields worth preparing for it.
ReachedCells reached_from(const PoseWindow& window, std::span<const PointCells> points, double resolution_m) {
  const auto [sine, cosine] = sin_cos(window.centre.theta_rad);
  const double half_turn = std::min(0.5 * window.half_theta_rad, 1.5707963267948966);
  const double chord = 2.0 * sin_cos(half_turn).sin;  // chord that a point at range 1 covers
  double low_x = 1.0e9;
  double low_y = 1.0e9;
  double high_x = -1.0e9;
  double high_y = -1.0e9;
  for (const PointCells& point : points) {
    const double px = static_cast<double>(point.x);
    const double py = static_cast<double>(point.y);
    const double moved = chord * std::sqrt(px * px + py * py);
    const double x = cosine * px - sine * py;
    const double y = sine * px + cosine * py;
    low_x = std::min(low_x, x - moved);
    low_y = std::min(low_y, y - moved);
    high_x = std::max(high_x, x + moved);
    high_y = std::max(high_y, y + moved);
  }
  const double centre_x = window.centre.x_m / resolution_m;
  const double centre_y = window.centre.y_m / resolution_m;
  const auto cell = [](double value) {
    return static_cast<std::int32_t>(std::floor(std::clamp(value, -1.0e8, 1.0e8)));
  };
  const bool is_near = std::max(window.half_x_m, window.half_y_m) <= kNear_m && window.half_theta_rad <= kNear_rad;
  const CellBox box{{cell(centre_x + low_x - window.half_x_m / resolution_m) - 1,
                     cell(centre_y + low_y - window.half_y_m / resolution_m) - 1},
                    {cell(centre_x + high_x + window.half_x_m / resolution_m) + 2,
                     cell(centre_y + high_y + window.half_y_m / resolution_m) + 2}};
  return {box, is_near ? CertifiedMap::kNearWindows : CertifiedMap::kSmallWindows};
}

}  // namespace

/// The part of a growing map that a scan can reach from a window of poses, prepared for certified matching; kept as
/// long as neither the part nor its cells change. The part depends on the window alone, so results do not depend on
/// earlier searches. Not thread-safe. Cost: some 2 ns a cell when it is made for a window of up to a metre, 4 ns for a
/// larger one; otherwise a comparison of its cells.
class CertifiedCrop {
 public:
  /// Distances count up to `cap`, 1/256 cell, or up to the map's cap if that is less.
  explicit CertifiedCrop(std::uint32_t cap) : cap_(cap) {}
  const CertifiedMap& of(const GlobalField& map, const ReachedCells& reached, Isa isa);

 private:
  std::uint32_t cap_;
  CellBox box_{};
  CertifiedMap::Windows windows_ = CertifiedMap::kSmallWindows;
  std::vector<std::uint16_t> cells_;
  std::vector<std::uint16_t> fresh_;
  std::unique_ptr<CertifiedMap> prepared_;
};

const CertifiedMap& CertifiedCrop::of(const GlobalField& map, const ReachedCells& reached, Isa isa) {
  const auto cap = static_cast<std::uint16_t>(std::min<std::uint32_t>(map.cap(), cap_));
  const CellBox box = whole_grains(reached.box);
  copy_cells(map, box, cap, fresh_);
  const bool is_same = prepared_ != nullptr && reached.windows == windows_ && box == box_ && fresh_ == cells_;
  if (is_same) return *prepared_;
  prepared_.reset();
  box_ = box;
  windows_ = reached.windows;
  cells_.swap(fresh_);
  const auto width = static_cast<std::uint32_t>(box.width());
  const FieldView part{.cells = cells_.data(),
                       .width = width,
                       .height = static_cast<std::uint32_t>(box.height()),
                       .stride = width,
                       .first_cell = box.min,
                       .cap = cap,
                       .resolution_m = map.geometry().resolution_m};
  prepared_ = std::make_unique<CertifiedMap>(part, isa, windows_);
  return *prepared_;
}

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
  points_ = points;
  by_odometry_ = prediction.by_odometry;
  rules_.begin(prediction, points.size());
  objective_.set_anchor(rules_.anchor());
  objective_.set_prior(rules_.prior());
  const std::uint64_t before = objective_.evaluations();
  attempts_ = 0;
  proven_gap_m_.reset();
  proof_evaluations_ = 0;
  descend(std::array{rules_.predicted()});
  Estimate best = estimate(0);
  if (must_search || matcher_->always_searches ||
      (search_.when != SearchWhen::kNever && rules_.may_search() &&
       (rules_.is_suspect(best.evidence) || rules_.is_far(best.pose)))) {
    best = search(best);
  }
  MatchResult result = rules_.judged(best.pose, best.evidence);
  result.evaluations = static_cast<std::uint32_t>(objective_.evaluations() - before + proof_evaluations_);
  result.proven_gap_m = proven_gap_m_;
  result.attempts = attempts_;
  return result;
}

// Equation (8): points farther from the map than the gate do not count, but a minimum share always does.
void ScanMatcher::keep_points_within(std::uint32_t gate, const CellPose& pose) {
  gated_.resize(points_.size());
  objective_.residuals(pose, points_, gated_);
  kept_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (gated_[i] <= gate) kept_.push_back(points_[i]);
  }
  const bool enough = static_cast<double>(kept_.size()) >= gate_.min_share * static_cast<double>(points_.size());
  objective_.set_points(enough ? std::span<const PointCells>(kept_) : points_);
}

// Equations (8) and (4) in turn, the gate narrowing around the best pose so far.
void ScanMatcher::descend_through_gates(PolishedPose& pose, std::span<std::uint16_t> values) {
  for (const DescentStage& stage : rules_.stages()) {
    keep_points_within(stage.gate, {pose.x, pose.y, pose.theta});
    const LocalMinimum found = matcher_->descend(objective_, {pose.x, pose.y, pose.theta}, stage.simplex, optimizer_);
    pose = {found.pose.x, found.pose.y, found.pose.theta};
    pose.stop = found.stop == StopReason::kConverged ? 1 : 2;
  }
  objective_.residuals({pose.x, pose.y, pose.theta}, points_, values);
}

double ScanMatcher::mean_range_cells() const {
  double sum = 0.0;
  for (const PointCells& point : points_) sum += static_cast<double>(std::sqrt(point.x * point.x + point.y * point.y));
  return sum / static_cast<double>(points_.size());
}

// Descends from each start; the ends and the values under all points there are then those of ends_ and values_.
void ScanMatcher::descend(std::span<const CellPose> starts) {
  objective_.set_cap(map_->cap());
  objective_.set_points(points_);
  ends_.clear();
  for (const CellPose& start : starts) ends_.push_back({start.x, start.y, start.theta});
  values_.resize(ends_.size() * row());
  if (matcher_->follows_slope) {
    // A sample of a window is nearer to its minimum than the prediction may be.
    objective_.descend(attempts_ > 0 ? rules_.descent_from_sample() : rules_.descent(mean_range_cells()), ends_,
                       values_);
    return;
  }
  for (std::size_t k = 0; k < ends_.size(); ++k) descend_through_gates(ends_[k], values_at(k));
}

std::span<std::uint16_t> ScanMatcher::values_at(std::size_t end) {
  return std::span(values_).subspan(end * row(), points_.size());
}

ScanMatcher::Estimate ScanMatcher::estimate(std::size_t end) {
  const std::uint32_t gate = rules_.final_gate();
  const std::uint32_t wide = rules_.wide_gate();
  const std::uint16_t cap = map_->cap();
  EvidenceCounts counts;
  for (const std::uint16_t value : values_at(end)) {
    counts.sum += std::min<std::uint32_t>(value, wide);
    counts.near += value <= gate ? 1U : 0U;
    counts.known += value < cap ? 1U : 0U;
    counts.beside += value > 2 * gate && value < cap ? 1U : 0U;
  }
  const PolishedPose& pose = ends_[end];
  Estimate estimate{{pose.x, pose.y, pose.theta}, rules_.evidence(counts)};
  estimate.evidence.stop = stop_reason(pose.stop);
  return estimate;
}

// Points over unknown cells give no information about the pose, but a pose that pulls them onto known walls looks
// better for it; so they do not vote, unless the local estimate is so suspect that it cannot identify them.
void ScanMatcher::choose_voters(const Estimate& local) {
  voters_.clear();
  const bool trusted = !rules_.is_suspect(local.evidence);
  const std::uint32_t limit = std::min<std::uint32_t>(rules_.wide_gate(), map_->cap());
  votes_.resize(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    votes_[i] = !trusted || values_[i] < limit ? 1 : 0;
    if (votes_[i] != 0) voters_.push_back(points_[i]);
  }
  thin(voters_, static_cast<std::size_t>(search_.max_points), thinned_);
}

std::uint64_t ScanMatcher::cost_to_voters(std::size_t end) {
  const std::span<const std::uint16_t> values = values_at(end);
  const std::uint32_t wide = rules_.wide_gate();
  std::uint64_t cost = objective_.prior_cost({ends_[end].x, ends_[end].y, ends_[end].theta});
  for (std::size_t i = 0; i < values.size(); ++i) {
    cost += votes_[i] * std::min<std::uint32_t>(values[i], wide);
  }
  return cost;
}

// Starts of descents in a window.
std::vector<CellPose> ScanMatcher::starts_in(const SearchWindow& window) {
  if (crop_ != nullptr && !voters_.empty() && voters_.size() <= kMostCertifiedPoints) return {prove_in(window)};
  objective_.set_points(thinned_);
  objective_.set_cap(rules_.wide_gate());
  return best_samples(objective_, window, static_cast<std::uint32_t>(search_.starts));
}

// The best pose of a window for all voters, up to the gap, by the same cost as in search().
CellPose ScanMatcher::prove_in(const SearchWindow& window) {
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
  return objective_.to_cells(found.T_map_base);
}

// Far away some place always looks alike: a pose that the odometry contradicts must be clearly better, and one that
// only a wider window holds, if windows follow without a doubt.
bool ScanMatcher::is_leap(const CellPose& pose, const CellPose& local, const SearchWindow& before) const {
  if (!by_odometry_) return false;
  return (rules_.is_far(pose) && !rules_.is_far(local)) ||
         (matcher_->always_searches && attempts_ > 1 && !before.holds(pose));
}

// Searches a window around the prediction, twice as large each time while its result is suspect or on its edge.
ScanMatcher::Estimate ScanMatcher::search(const Estimate& local) {
  Estimate best = local;
  choose_voters(local);
  std::uint64_t best_cost = cost_to_voters(0);
  SearchWindow before;
  while (attempts_ < static_cast<std::uint32_t>(search_.attempts)) {
    const SearchWindow window = rules_.window(std::ldexp(1.0, static_cast<int>(attempts_)));
    const std::vector<CellPose> starts = starts_in(window);
    ++attempts_;
    descend(starts);
    bool at_edge = false;
    for (std::size_t k = 0; k < starts.size(); ++k) {
      const CellPose pose{ends_[k].x, ends_[k].y, ends_[k].theta};
      std::uint64_t cost = cost_to_voters(k);
      if (is_leap(pose, local.pose, before)) {
        cost = static_cast<std::uint64_t>(static_cast<double>(cost) / leap_gain_);
      }
      if (cost >= best_cost || !rules_.is_possible(pose)) continue;
      best = estimate(k);
      best_cost = cost;
      at_edge = window.has_at_edge(pose);
    }
    if (!rules_.may_search() || (!rules_.is_suspect(best.evidence) && !at_edge)) break;
    before = window;
  }
  return best;
}

}  // namespace gdtslam

#include "loop_finder.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/core/free_memory.hpp"
#include "engine/mapping/map/keyframe_map.hpp"
#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {
namespace {

constexpr double kReferenceSpacing_m = 0.03;
constexpr double kQuerySpacing_m = 0.1;
constexpr double kSearchIndependent = 60.0;  // points of a scan that tell something new, in the cost of a search
constexpr double kLeastPrior_m = 0.05;       // of the prior: less would be believed only of a graph without mistakes
constexpr double kLeastPrior_rad = 0.005;
constexpr double kNearWindow_m = 0.8;  // half windows that are cheap to prepare for
constexpr double kNearWindow_rad = 0.5;

MapperConfig field_config(double resolution_m) {
  MapperConfig config;
  config.map.resolution_m = resolution_m;
  config.merge.threshold_m = resolution_m;
  return config;
}

FieldCopy field_of(const std::vector<Point2>& points_m, double resolution_m, Backend& backend) {
  const MapperConfig config = field_config(resolution_m);
  KeyframeMap map(config, backend);
  StageTimes times;
  map.merge(keyframe_of(points_m, resolution_m, config.map.radius_cells()), times);
  return FieldCopy(map.field);
}

// Cost units that one sigma squared is worth: a point that is a cell off costs 256, and of `points` only some are
// independent.
WindowPrior prior_of(const Revisit& revisit, double resolution_m, std::size_t points) {
  const double unit = 0.25 * 256.0 * static_cast<double>(points) / kSearchIndependent;
  const double cells = std::max(kLeastPrior_m, revisit.sigma_m) / resolution_m;
  const double radians = std::max(kLeastPrior_rad, revisit.sigma_rad);
  WindowPrior prior;
  prior.mean = revisit.T_place_here;
  prior.weight_xy = static_cast<float>(unit / (cells * cells));
  prior.weight_theta = static_cast<float>(unit / (radians * radians));
  return prior;
}

std::vector<Point2> every_nth(const std::vector<Point2>& points, std::size_t most) {
  const std::size_t step = (points.size() + most - 1) / std::max<std::size_t>(1, most);
  if (step <= 1) return points;
  std::vector<Point2> taken;
  for (std::size_t i = 0; i < points.size(); i += step) taken.push_back(points[i]);
  return taken;
}

}  // namespace

/// A group that others are searched in.
struct LoopFinder::Reference {
  Reference(const KeyframePath& keyframes, std::size_t middle, const LoopSearchOptions& options, Backend& backend)
      : group(keyframes, middle, options.reference_half_m, kReferenceSpacing_m),
        field(field_of(group.points(), options.resolution_m, backend)) {}

  /// Prepared for windows of this size: most are small, and far cheaper to prepare for.
  const CertifiedMap& certified_for(const PoseWindow& window) {
    const bool is_near = window.half_x_m <= kNearWindow_m && window.half_theta_rad <= kNearWindow_rad;
    Prepared& prepared = is_near ? for_near : for_any;
    if (!prepared.map) {
      prepared.map.emplace(field.view(), best_isa(), is_near ? CertifiedMap::kNearWindows : CertifiedMap::kAnyWindows);
      prepared.bytes = prepared.map->bytes();
    }
    return *prepared.map;
  }

  [[nodiscard]] std::size_t bytes() const {
    return group.space().bytes() + field.bytes() + for_near.bytes + for_any.bytes;
  }
  [[nodiscard]] std::size_t prepared_bytes() const {
    return (for_near.map ? for_near.bytes : 0U) + (for_any.map ? for_any.bytes : 0U);
  }

  /// Made when it is searched in.
  struct Prepared {
    std::optional<CertifiedMap> map;
    std::size_t bytes = 0;  ///< of the map, whether it is there or was
  };

  ScanGroup group;
  FieldCopy field;
  Prepared for_near;
  Prepared for_any;
  std::uint64_t asked = 0;  // when it was last
};

LoopFinder::LoopFinder(const LoopSearchOptions& options) : options_(options), backend_(make_cpu_backend({})) {}

LoopFinder::~LoopFinder() = default;

void LoopFinder::add_place(std::size_t keyframe) {
  places_.push_back(keyframe);
  path_m_.push_back(keyframes_.path_m[keyframe]);
}

void LoopFinder::forget_bent() {
  std::erase_if(references_, [&](const auto& entry) { return entry.second->group.is_bent(keyframes_.poses); });
}

LoopFinder::Reference& LoopFinder::reference_at(std::size_t place) {
  std::unique_ptr<Reference>& reference = references_[place];
  if (!reference) reference = std::make_unique<Reference>(keyframes_, places_[place], options_, *backend_);
  reference->asked = ++asked_;
  return *reference;
}

// Of those that were asked for longest ago first; what is prepared for the one at `place` stays.
void LoopFinder::forget_prepared(std::size_t place) {
  std::size_t bytes = 0;
  std::vector<Reference*> older;
  older.reserve(references_.size());
  for (const auto& [at, reference] : references_) {
    bytes += reference->prepared_bytes();
    if (at != place) older.push_back(reference.get());
  }
  if (bytes <= options_.most_prepared_bytes) return;
  std::sort(older.begin(), older.end(), [](const Reference* a, const Reference* b) { return a->asked < b->asked; });
  for (Reference* const reference : older) {
    if (bytes <= options_.most_prepared_bytes / 2) break;  // seldom much, rather than often little
    bytes -= reference->prepared_bytes();
    reference->for_near.map.reset();
    reference->for_any.map.reset();
  }
  return_free_memory();
}

// Those that were asked for longest ago go first; the one at `place` stays.
void LoopFinder::make_room(std::size_t place) {
  forget_prepared(place);
  std::size_t bytes = 0;
  for (const auto& [at, reference] : references_) bytes += reference->bytes();
  while (bytes > options_.most_bytes && references_.size() > 1) {
    const auto oldest = std::min_element(references_.begin(), references_.end(), [](const auto& a, const auto& b) {
      return a.second->asked < b.second->asked;
    });
    if (oldest->first == place) return;
    bytes -= oldest->second->bytes();
    references_.erase(oldest);
  }
}

Pose2 LoopFinder::search(Reference& reference, const ScanGroup& query, const Revisit& revisit) {
  const std::vector<PointCells> points = in_cells(every_nth(query.points(), options_.points), options_.resolution_m);
  const double half_m = options_.revisits.half_m(revisit);
  const PoseWindow window{.centre = revisit.T_place_here,
                          .half_x_m = half_m,
                          .half_y_m = half_m,
                          .half_theta_rad = options_.revisits.half_rad(revisit)};
  CertifiedOptions options;
  options.gap_m = options_.gap_m;
  options.max_boxes = options_.most_boxes;
  options.starts = {revisit.T_place_here};
  options.prior = prior_of(revisit, options_.resolution_m, points.size());
  const CertifiedResult result = find_pose(reference.certified_for(window), points, window, options);
  ++counts_.searched;
  counts_.boxes += result.boxes;
  return result.T_map_base;
}

std::vector<Loop> LoopFinder::look(const PoseGraph& graph, std::size_t here) {
  const auto has = [&](std::size_t place) {
    return std::any_of(graph.loops.begin(), graph.loops.end(), [&](const Loop& loop) {
      return loop.relation.from == place && loop.relation.to == here && loop.is_on();
    });
  };
  std::vector<Loop> loops;
  std::optional<ScanGroup> query;
  const GraphCovariance covariance(graph);
  for (const Revisit& revisit : revisits_of(graph, covariance, path_m_, here, options_.revisits)) {
    if (has(revisit.place)) continue;
    if (!query) query.emplace(keyframes_, places_[here], options_.query_half_m, kQuerySpacing_m);
    Reference& reference = reference_at(revisit.place);
    const Pose2 T_place_here = search(reference, *query, revisit);
    make_room(revisit.place);
    const LoopEvidence evidence = weigh_loop(reference.group, *query, T_place_here);
    if (!is_possible(evidence, options_.limits)) continue;
    ++counts_.found;
    loops.push_back({{revisit.place, here, T_place_here, loop_information(evidence)}, 1.0});
  }
  return loops;
}

}  // namespace gdtslam

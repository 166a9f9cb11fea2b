#include "loop_finder.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/core/memory/free_memory.hpp"
#include "engine/core/memory/sparing.hpp"
#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {
namespace {

constexpr double kReferenceSpacing_m = 0.03;
constexpr double kQuerySpacing_m = 0.1;
constexpr double kSearchIndependent = 60.0;  // independent points of a scan, in the cost of a search
constexpr double kLeastPrior_m = 0.05;       // least sigma of the prior: less needs a graph without mistakes
constexpr double kLeastPrior_rad = 0.005;
constexpr std::size_t kAheadAThread = 4;  // places searched ahead, before it is known whether the graph stays
constexpr double kNearWindow_m = 0.8;     // half windows that are cheap to prepare for
constexpr double kNearWindow_rad = 0.5;
// A window that is at most so much wider than an earlier one, and its centre at most this share of that away, holds no
// other answer.
constexpr double kAsWide = 1.05;
constexpr double kAsFar = 1.0 / 3.0;
constexpr double kElsewhere_m = 1.0;  // poses this near the best one, with a similar heading, are the same answer
constexpr double kElsewhere_rad = 0.35;
constexpr double kAsGoodChi2 = 16.0;  // a pose that costs no more than this above the best one may be right as well

// Cost of one sigma squared: a point that is a cell off costs 256, and only some of `points` are independent.
double unit_of_chi2(std::size_t points) { return 0.25 * 256.0 * static_cast<double>(points) / kSearchIndependent; }

WindowPrior make_prior(const Revisit& revisit, double resolution_m, std::size_t points) {
  const double unit = unit_of_chi2(points);
  const double cells = std::max(kLeastPrior_m, revisit.sigma_m) / resolution_m;
  const double radians = std::max(kLeastPrior_rad, revisit.sigma_rad);
  WindowPrior prior;
  prior.mean = revisit.T_place_here;
  prior.weight_xy = static_cast<float>(unit / (cells * cells));
  prior.weight_theta = static_cast<float>(unit / (radians * radians));
  return prior;
}

}  // namespace

/// A group that others are searched in.
struct LoopFinder::Reference {
  Reference(const KeyframePath& keyframes, std::size_t middle, const LoopSearchOptions& options, Backend& backend,
            std::mutex& backend_mutex)
      : group(keyframes, middle, options.reference_half_m, kReferenceSpacing_m),
        field(make_distance_field(group.points(), options.resolution_m, backend, backend_mutex)) {}

  /// Returns the map for a window of this size: most windows are small and far cheaper to prepare.
  const CertifiedMap& certified_for(bool is_near) {
    const std::lock_guard lock(mutex);
    Prepared& prepared = prepared_for(is_near);
    if (!prepared.map) {
      prepared.map.emplace(field.view(), best_isa(),
                           is_near ? CertifiedMap::kNearWindows : CertifiedMap::kSmallWindows);
      prepared.bytes = prepared.map->bytes();
    }
    return *prepared.map;
  }

  [[nodiscard]] std::size_t bytes() const {
    return group.space().bytes() + field.bytes() + (for_near.is_counted ? for_near.bytes : 0U) +
           (for_wide.is_counted ? for_wide.bytes : 0U);
  }
  [[nodiscard]] std::size_t prepared_bytes() const {
    return (for_near.map ? for_near.bytes : 0U) + (for_wide.map ? for_wide.bytes : 0U);
  }

  /// Made at the first search in it.
  struct Prepared {
    std::optional<CertifiedMap> map;
    std::size_t bytes = 0;    ///< memory of the map, present or forgotten
    bool is_counted = false;  ///< a search in it was taken
  };
  Prepared& prepared_for(bool is_near) { return is_near ? for_near : for_wide; }

  ScanGroup group;
  FieldCopy field;
  std::mutex mutex;  // guards the prepared fields
  Prepared for_near;
  Prepared for_wide;
  std::uint64_t number = 0;  // distinguishes it from earlier and later references of the same place
  std::uint64_t asked = 0;   // time of the last request
};

/// A reference that is requested and not kept yet.
struct LoopFinder::Fresh {
  std::once_flag once;
  std::unique_ptr<Reference> reference;
};

/// Result of a search for a revisit.
struct LoopFinder::Found {
  Revisit revisit;
  std::uint64_t number = 0;  ///< number of the reference; 0: a fresh one
  bool is_near = false;      ///< the window is small
  Pose2 T_place_here;
  LoopEvidence evidence;
  std::optional<Pose2> T_otherwise;  ///< a pose elsewhere in the window that fits about as well
  std::uint64_t boxes = 0;
};

// An ambiguous place gives only the information that both poses share: none along the line between them.
Matrix3 LoopFinder::found_information(const Found& found) {
  const Matrix3 information = loop_information(found.evidence);
  if (!found.T_otherwise) return information;
  const Tangent2 apart = log_tangent(between(found.T_place_here, *found.T_otherwise));
  return inverse(inverse(information) + outer(apart, apart));
}

LoopFinder::LoopFinder(const LoopSearchOptions& options) : options_(options), backend_(make_cpu_backend({})) {}

LoopFinder::~LoopFinder() = default;

void LoopFinder::add_place(std::size_t keyframe) {
  push_sparingly(places_, keyframe);
  push_sparingly(path_m_, keyframes_.path_m[keyframe]);
}

void LoopFinder::leave_out(std::size_t place) {
  is_left_out_.resize(places_.size());
  is_left_out_[place] = true;
  references_.erase(place);
}

void LoopFinder::end() {
  references_.clear();
  return_free_memory();
}

void LoopFinder::forget_bent() {
  std::erase_if(references_, [&](const auto& entry) { return entry.second->group.is_bent(keyframes_.poses); });
}

// Returns the kept or a fresh reference; the set of kept ones does not change meanwhile.
LoopFinder::Reference& LoopFinder::reference_at(std::size_t place) {
  if (const auto kept = references_.find(place); kept != references_.end()) return *kept->second;
  Fresh* fresh = nullptr;
  {
    const std::lock_guard lock(fresh_mutex_);
    std::unique_ptr<Fresh>& slot = fresh_[place];
    if (!slot) slot = std::make_unique<Fresh>();
    fresh = slot.get();
  }
  std::call_once(fresh->once, [&] {
    fresh->reference = std::make_unique<Reference>(keyframes_, places_[place], options_, *backend_, backend_mutex_);
  });
  return *fresh->reference;
}

// Forgets first the fields whose last use is longest ago; the prepared one at `place` stays.
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
    if (bytes <= options_.most_prepared_bytes / 2) break;  // rarely many, rather than often few
    bytes -= reference->prepared_bytes();
    reference->for_near.map.reset();
    reference->for_wide.map.reset();
  }
}

// Drops first the references whose last use is longest ago; the one at `place` stays.
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

void LoopFinder::search(Reference& reference, const ScanGroup& query, Found& found) {
  const Revisit& revisit = found.revisit;
  const std::vector<PointCells> points = in_cells(every_nth(query.points(), options_.points), options_.resolution_m);
  const double half_m = options_.revisits.half_m(revisit);
  const PoseWindow window{.centre = revisit.T_place_here,
                          .half_x_m = half_m,
                          .half_y_m = half_m,
                          .half_theta_rad = options_.revisits.half_rad(revisit)};
  CertifiedOptions options;
  options.gap_m = options_.gap_m;
  options.max_boxes = options_.most_boxes;
  options.counts_window = false;  // the window is wide if the heading is uncertain
  options.starts = {revisit.T_place_here};
  options.prior = make_prior(revisit, options_.resolution_m, points.size());
  found.is_near = window.half_x_m <= kNearWindow_m && window.half_theta_rad <= kNearWindow_rad;
  const CertifiedResult result = find_pose(reference.certified_for(found.is_near), points, window, options);
  found.boxes = result.boxes;
  found.T_place_here = result.T_map_base;
  found.evidence = weigh_loop(reference.group, query, found.T_place_here);
  const bool is_wide = half_m > kElsewhere_m || window.half_theta_rad > kElsewhere_rad;
  if (!is_wide || !is_possible(found.evidence, options_.limits)) return;
  options.starts = {};
  options.excluded = {{result.T_map_base, kElsewhere_m, kElsewhere_rad}};
  options.wanted_bound = result.cost + static_cast<std::uint32_t>(kAsGoodChi2 * unit_of_chi2(points.size()));
  options.max_boxes = options_.most_boxes / 5;
  const CertifiedResult second = find_pose(reference.certified_for(found.is_near), points, window, options);
  found.boxes += second.boxes;
  if (second.stop == CertifiedStop::kNothingAllowed || second.cost > options.wanted_bound) return;
  if (!is_possible(weigh_loop(reference.group, query, second.T_map_base), options_.limits)) return;
  found.T_otherwise = second.T_map_base;
}

LoopFinder::Found LoopFinder::find(const Revisit& revisit, const ScanGroup& query) {
  Reference& reference = reference_at(revisit.place);
  Found found;
  found.revisit = revisit;
  found.number = reference.number;
  search(reference, query, found);
  return found;
}

ScanGroup LoopFinder::query_at(std::size_t here) const {
  return {keyframes_, places_[here], options_.query_half_m, kQuerySpacing_m};
}

// Places without any surface around them are left out of the search and take no turn.
std::vector<bool> LoopFinder::left_out_before(std::size_t here) const {
  std::vector<bool> left_out = is_left_out_;
  left_out.resize(std::max(left_out.size(), here));
  for (std::size_t place = 0; place < here; ++place) {
    if (!left_out[place]) left_out[place] = !have_points(keyframes_, places_[place], options_.reference_half_m);
  }
  return left_out;
}

// True if a search found nothing in about this window.
bool LoopFinder::was_in_vain(const Revisit& revisit, std::size_t here) const {
  const auto before = in_vain_.find({revisit.place, here});
  if (before == in_vain_.end()) return false;
  const double half_m = options_.revisits.half_m(before->second);
  const double half_rad = options_.revisits.half_rad(before->second);
  const Pose2 moved = between(before->second.T_place_here, revisit.T_place_here);
  return options_.revisits.half_m(revisit) < kAsWide * half_m &&
         options_.revisits.half_rad(revisit) < kAsWide * half_rad && translation_length(moved) < kAsFar * half_m &&
         std::fabs(moved.theta_rad) < kAsFar * half_rad;
}

std::vector<Revisit> LoopFinder::wanted_revisits(const PoseGraph& graph, const GraphCovariance& covariance,
                                                 std::size_t here, std::size_t most) const {
  if (here < is_left_out_.size() && is_left_out_[here]) return {};
  if (!have_points(keyframes_, places_[here], options_.query_half_m)) return {};
  RevisitRules rules = options_.revisits;
  rules.most = most;
  std::vector<Revisit> revisits = find_revisits(graph, covariance, path_m_, here, rules, left_out_before(here));
  std::erase_if(revisits, [&](const Revisit& revisit) {
    return std::any_of(graph.loops.begin(), graph.loops.end(), [&](const Loop& loop) {
      return loop.relation.from == revisit.place && loop.relation.to == here && loop.is_on() && !loop.is_ambiguous;
    });
  });
  std::erase_if(revisits, [&](const Revisit& revisit) { return was_in_vain(revisit, here); });
  return revisits;
}

std::vector<LoopFinder::Found> LoopFinder::look_ahead(const PoseGraph& graph, const GraphCovariance& covariance,
                                                      std::size_t here) {
  std::vector<Found> all;
  const std::vector<Revisit> revisits = wanted_revisits(graph, covariance, here, options_.revisits.most);
  if (revisits.empty()) return all;
  const ScanGroup query = query_at(here);
  all.reserve(revisits.size());
  for (const Revisit& revisit : revisits) all.push_back(find(revisit, query));
  return all;
}

// References are kept and dropped only when results are taken, in one thread.
void LoopFinder::take_reference(const Found& found) {
  const std::size_t place = found.revisit.place;
  std::unique_ptr<Reference>& kept = references_[place];
  if (!kept) {
    if (const auto fresh = fresh_.find(place); fresh != fresh_.end()) {
      kept = std::move(fresh->second->reference);
      fresh_.erase(fresh);
    }
    if (!kept) kept = std::make_unique<Reference>(keyframes_, places_[place], options_, *backend_, backend_mutex_);
    kept->number = ++made_;
  }
  if (kept->prepared_for(found.is_near).bytes == 0) kept->certified_for(found.is_near);
  kept->asked = ++asked_;
  kept->prepared_for(found.is_near).is_counted = true;
  make_room(place);
}

// A kept reference may have been dropped meanwhile to make room: then a fresh one is searched.
std::vector<Loop> LoopFinder::take(std::vector<Found> all, std::size_t here) {
  std::vector<Loop> loops;
  for (Found& found : all) {
    const auto kept = references_.find(found.revisit.place);
    const bool is_as_it_was = found.number == 0 || (kept != references_.end() && kept->second->number == found.number);
    if (!is_as_it_was) found = find(found.revisit, query_at(here));
    take_reference(found);
    ++counts_.searched;
    counts_.boxes += found.boxes;
    if (!is_possible(found.evidence, options_.limits)) {
      in_vain_.insert_or_assign({found.revisit.place, here}, found.revisit);
      continue;
    }
    ++counts_.found;
    loops.push_back({.relation = {found.revisit.place, here, found.T_place_here, found_information(found)},
                     .is_ambiguous = found.T_otherwise.has_value()});
  }
  return loops;
}

// One search after the other needs less memory than all side by side.
std::vector<Loop> LoopFinder::look(const PoseGraph& graph, const GraphCovariance& covariance, std::size_t here,
                                   std::size_t most, WorkerPool& workers) {
  std::vector<Loop> loops;
  const std::vector<Revisit> revisits = wanted_revisits(graph, covariance, here, most);
  if (revisits.empty()) return loops;
  const ScanGroup query = query_at(here);
  const std::size_t at_once = workers.threads() > 1 ? revisits.size() : 1;
  for (std::size_t first = 0; first < revisits.size(); first += at_once) {
    std::vector<Found> all(at_once);
    workers.run(at_once, 1, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t k = begin; k < end; ++k) all[k] = find(revisits[first + k], query);
    });
    const std::vector<Loop> found = take(std::move(all), here);
    loops.insert(loops.end(), found.begin(), found.end());
  }
  fresh_.clear();
  return loops;
}

void LoopFinder::look_at(const PoseGraph& graph, std::size_t first, std::size_t end, WorkerPool& workers,
                         const Take& take_loops) {
  const std::size_t most_ahead = workers.threads() > 1 ? kAheadAThread * workers.threads() : 1;
  std::size_t places = 1;  // searched together: places after one that changes the graph are searched again
  std::optional<GraphCovariance> covariance;  // of the graph as it is
  for (std::size_t here = first; here < end;) {
    if (!covariance) covariance.emplace(graph);
    if (places == 1) {
      const bool changes = take_loops(here, look(graph, *covariance, here, options_.revisits.most, workers));
      if (changes) covariance.reset();
      if (!changes) places = std::min<std::size_t>(2, most_ahead);
      ++here;
      continue;
    }
    std::vector<std::vector<Found>> ahead(std::min(places, end - here));
    workers.run(ahead.size(), 1, [&](std::uint64_t from, std::uint64_t to) {
      for (std::uint64_t k = from; k < to; ++k) ahead[k] = look_ahead(graph, *covariance, here + k);
    });
    bool has_changed = false;
    for (std::size_t k = 0; k < ahead.size() && !has_changed; ++k, ++here) {
      has_changed = take_loops(here, take(std::move(ahead[k]), here));
    }
    if (has_changed) covariance.reset();
    if (!has_changed) fresh_.clear();
    places = has_changed ? 1 : std::min(2 * places, most_ahead);
  }
  fresh_.clear();
}

}  // namespace gdtslam

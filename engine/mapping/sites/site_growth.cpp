#include "site_growth.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "engine/mapping/sites/growing_site.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostRounds = 4;    // rounds for sessions that are left over
constexpr std::size_t kMostGrowths = 16;  // repetitions until no session is refuted

using Sites = std::vector<std::unique_ptr<GrowingSite>>;

// Orders sessions by the extent of their walls, largest first.
std::vector<std::size_t> widest_first(const std::vector<Session>& sessions) {
  std::vector<std::size_t> seen;
  seen.reserve(sessions.size());
  for (const Session& session : sessions) seen.push_back(count_wall_points(session));
  std::vector<std::size_t> order(sessions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return seen[a] > seen[b]; });
  return order;
}

class SiteGrowth {
 public:
  SiteGrowth(const std::vector<Session>& sessions, const OverlapOptions& options, WorkerPool& workers,
             const MergeProgress& progress)
      : sessions_(sessions),
        options_(options),
        workers_(workers),
        progress_(progress),
        belongs_nowhere_(sessions.size()),
        is_undecided_(sessions.size()),
        lies_anywhere_(sessions.size()),
        refuted_(sessions.size()) {}

  GrownSites run();

 private:
  void add(std::size_t session);
  [[nodiscard]] bool is_everywhere(const SessionOverlap& overlap) const;
  void leave_out_repeated(std::size_t session, std::vector<SessionOverlap>& overlaps) const;
  void join(std::size_t session, const std::vector<std::vector<SessionEdge>>& edges_to);
  void grow();
  bool try_again();
  void verify();
  void verify(SessionSearch& search);
  [[nodiscard]] bool is_refuted(std::size_t session, std::size_t keyframe) const;
  [[nodiscard]] bool may_lie_elsewhere(const SessionSearch& search);
  [[nodiscard]] bool lies_in_two_ways_elsewhere(std::size_t session);
  [[nodiscard]] bool is_repeated(const SessionFix& fix, std::size_t query) const;
  void leave_out_refuted();
  void split();

  const std::vector<Session>& sessions_;
  OverlapOptions options_;
  WorkerPool& workers_;
  const MergeProgress& progress_;
  std::vector<char> belongs_nowhere_;  // sessions that fit in several spots of a site
  std::vector<char> is_undecided_;     // sessions that would lie in one without the evidence against it
  // Joined sessions that might as well lie elsewhere.
  std::vector<std::optional<SessionSearch>> lies_anywhere_;
  std::vector<std::vector<std::size_t>> refuted_;  // keyframes of a session whose fixes fit twice
  std::vector<std::size_t> refuted_now_;           // sessions, in this round
  KnownOverlaps overlaps_;
  Sites sites_;
  GrownSites grown_;
};

// If one site shows that the building can hold a session in two ways, a drive that saw only one of them does not show
// which it is.
bool lies_in_two_ways(const std::vector<SessionOverlap>& overlaps) {
  return std::any_of(overlaps.begin(), overlaps.end(), [](const SessionOverlap& overlap) { return overlap.rival > 0; });
}

// True if most of the places found in the site fit there several times.
bool SiteGrowth::is_everywhere(const SessionOverlap& overlap) const {
  return overlap.possible >= options_.agreement.least &&
         static_cast<double>(overlap.alone) < options_.alone_of_any * static_cast<double>(overlap.possible);
}

// Two alike wings, each seen by itself, are two sites. A place that fits twice in any site counts for none; one that
// fits in two sites counts only for the better supported one; a session with most places fitting twice belongs to no
// site.
void SiteGrowth::leave_out_repeated(std::size_t session, std::vector<SessionOverlap>& overlaps) const {
  const Session& query = sessions_[session];
  std::vector<SessionOverlap*> order(overlaps.size());
  std::transform(overlaps.begin(), overlaps.end(), order.begin(), [](SessionOverlap& overlap) { return &overlap; });
  std::stable_sort(order.begin(), order.end(),
                   [](const auto* a, const auto* b) { return a->held.size() > b->held.size(); });
  const auto is_single = [&](const SessionOverlap& overlap) {
    return sites_[static_cast<std::size_t>(&overlap - overlaps.data())]->group().size() == 1;
  };
  for (std::size_t k = 0; k < order.size(); ++k) {
    SessionOverlap& overlap = *order[k];
    const bool belongs_nowhere = std::any_of(overlaps.begin(), overlaps.end(), [&](const SessionOverlap& other) {
      return is_everywhere(other) && 2 * other.possible >= overlap.possible;
    });
    std::erase_if(overlap.held, [&](const SessionFix& fix) {
      return belongs_nowhere || is_refuted(session, fix.keyframe) ||
             std::any_of(order.begin(), order.end(),
                         [&](const auto* other) { return other->repeats(query, fix.keyframe); }) ||
             (is_single(overlap) &&
              std::any_of(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(k),
                          [&](const auto* stronger) { return stronger->finds(query, fix.keyframe); }));
    });
    if (overlap.held.size() < options_.agreement.least) overlap.held.clear();
  }
}

// All sites that the session belongs to become one.
void SiteGrowth::join(std::size_t session, const std::vector<std::vector<SessionEdge>>& edges_to) {
  std::vector<std::size_t> group{session};
  std::vector<SessionEdge> edges;
  Sites others;
  for (std::size_t k = 0; k < sites_.size(); ++k) {
    if (edges_to[k].empty()) {
      others.push_back(std::move(sites_[k]));
      continue;
    }
    group.insert(group.end(), sites_[k]->group().begin(), sites_[k]->group().end());
    add_edges(edges, sites_[k]->edges());
    add_edges(edges, edges_to[k]);
  }
  std::sort(group.begin(), group.end());
  others.push_back(std::make_unique<GrowingSite>(std::move(group), sessions_, std::move(edges), options_.search));
  sites_ = std::move(others);
}

void SiteGrowth::add(std::size_t session) {
  if (lies_anywhere_[session]) {
    belongs_nowhere_[session] = 1;
    grown_.searches.push_back(*lies_anywhere_[session]);
    join(session, std::vector<std::vector<SessionEdge>>(sites_.size()));
    return;
  }
  std::vector<SessionOverlap> overlaps;
  overlaps.reserve(sites_.size());
  for (const auto& site : sites_) {
    const std::size_t first = site->group().front();
    const bool is_nowhere = site->group().size() == 1 && (belongs_nowhere_[first] != 0 || is_undecided_[first] != 0);
    overlaps.push_back(is_nowhere ? SessionOverlap{}
                                  : overlaps_.of(*site, sessions_[session], session, options_, workers_));
    refuse_doubtful(options_, overlaps.back());
  }
  belongs_nowhere_[session] = std::any_of(overlaps.begin(), overlaps.end(),
                                          [&](const SessionOverlap& overlap) { return is_everywhere(overlap); });
  is_undecided_[session] =
      std::any_of(overlaps.begin(), overlaps.end(), [](const SessionOverlap& overlap) { return overlap.is_undecided; });
  leave_out_repeated(session, overlaps);
  if (lies_in_two_ways(overlaps)) {
    for (SessionOverlap& overlap : overlaps) overlap.held.clear();
  }
  std::vector<std::vector<SessionEdge>> edges(sites_.size());
  for (std::size_t k = 0; k < sites_.size(); ++k) {
    for (const SessionFix& fix : overlaps[k].held) add_edges(edges[k], {sites_[k]->make_edge(session, fix)});
    if (overlaps[k].fixes.empty()) continue;
    grown_.searches.push_back({session, sites_[k]->group(), std::move(overlaps[k]), edges[k]});
  }
  join(session, edges);
}

// Adds the surest session first: a larger site shows repeats more reliably.
void SiteGrowth::grow() {
  sites_.clear();
  grown_ = {};
  const double least_alone = options_.least_alone;
  std::size_t done = 0;
  for (const std::size_t session : widest_first(sessions_)) {
    progress_("looking where sessions overlap", static_cast<double>(done++) / static_cast<double>(sessions_.size()));
    add(session);
  }
  for (std::size_t round = 0; round < kMostRounds && try_again(); ++round) continue;
  options_.least_alone = options_.alone_at_last;
  for (std::size_t round = 0; round < kMostRounds && try_again(); ++round) continue;
  options_.least_alone = least_alone;
}

// A wrongly joined session misled later ones, so the sites grow again without it.
GrownSites SiteGrowth::run() {
  for (std::size_t round = 0; round < kMostGrowths; ++round) {
    grow();
    refuted_now_.clear();
    verify();
    if (refuted_now_.empty()) break;
  }
  leave_out_refuted();
  split();
  return std::move(grown_);
}

bool SiteGrowth::is_refuted(std::size_t session, std::size_t keyframe) const {
  return std::any_of(refuted_[session].begin(), refuted_[session].end(),
                     [&](std::size_t refuted) { return are_at_one_place(sessions_[session], refuted, keyframe); });
}

// Tries sessions again that came while the sites were too small; returns true if any was joined.
bool SiteGrowth::try_again() {
  const bool is_more_there = sites_.size() < sessions_.size();  // than each session by itself
  std::vector<std::size_t> alone;
  for (const auto& site : sites_) {
    const std::size_t session = site->group().front();
    if (site->group().size() == 1 && belongs_nowhere_[session] == 0 && (is_more_there || is_undecided_[session] != 0)) {
      alone.push_back(session);
    }
  }
  std::size_t done = 0;
  const std::size_t before = sites_.size();
  for (const std::size_t session : alone) {
    progress_("looking once more where sessions overlap",
              static_cast<double>(done++) / static_cast<double>(alone.size()));
    // A session tried before it may have been joined with it.
    if (std::erase_if(sites_, [&](const auto& site) { return site->group() == std::vector{session}; }) == 0) continue;
    std::erase_if(grown_.searches, [&](const SessionSearch& search) { return search.query == session; });
    add(session);
  }
  return sites_.size() < before;
}

// Tests against all sites in the end.
bool SiteGrowth::is_repeated(const SessionFix& fix, std::size_t query) const {
  return std::any_of(sites_.begin(), sites_.end(), [&](const auto& site) {
    if (site->holds(query)) {
      return site->map().fits_elsewhere(sessions_[query], fix, site->T_site_keyframe(query, fix.keyframe));
    }
    if (site->group().size() == 1) return false;  // it was compared with these sites when it came, or they with it
    const SessionFix there = site->map().find(sessions_[query], fix.keyframe);
    return there.is_possible && !there.is_alone;
  });
}

// Compares the session as a whole with all of its site.
bool SiteGrowth::may_lie_elsewhere(const SessionSearch& search) {
  const auto site =
      std::find_if(sites_.begin(), sites_.end(), [&](const auto& each) { return each->holds(search.query); });
  const Session& query = sessions_[search.query];
  const std::size_t keyframe = search.edges.front().held.front().keyframe;
  const Pose2 T_site_query = (*site)->T_site_keyframe(search.query, keyframe) * inverse(query.poses[keyframe]);
  return (*site)->repeats(workers_).may_lie_elsewhere(query, T_site_query);
}

// Tests the other sites, which have grown since the session was searched in them.
bool SiteGrowth::lies_in_two_ways_elsewhere(std::size_t session) {
  std::vector<SessionOverlap> overlaps;
  for (const auto& site : sites_) {
    if (site->holds(session) || site->group().size() == 1) continue;
    overlaps.push_back(overlaps_.of(*site, sessions_[session], session, options_, workers_));
  }
  return lies_in_two_ways(overlaps);
}

void SiteGrowth::verify(SessionSearch& search) {
  std::size_t left = 0;
  std::vector<std::size_t> repeating;
  for (SessionEdge& edge : search.edges) {
    std::vector<char> repeated(edge.held.size());
    workers_.run(repeated.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t k = begin; k < end; ++k) repeated[k] = is_repeated(edge.held[k], search.query) ? 1 : 0;
    });
    std::vector<SessionFix> held;
    for (std::size_t k = 0; k < repeated.size(); ++k) {
      if (repeated[k] == 0) held.push_back(edge.held[k]);
      if (repeated[k] != 0) repeating.push_back(edge.held[k].keyframe);
    }
    left += held.size();
    edge.held = std::move(held);
  }
  std::erase_if(search.edges, [](const SessionEdge& edge) { return edge.held.empty(); });
  search.may_lie_elsewhere =
      left >= options_.agreement.least && (may_lie_elsewhere(search) || lies_in_two_ways_elsewhere(search.query));
  if (left >= options_.agreement.least && !search.may_lie_elsewhere) return;
  search.edges.clear();
  refuted_now_.push_back(search.query);
  if (search.may_lie_elsewhere) lies_anywhere_[search.query] = search;
  std::vector<std::size_t>& refuted = refuted_[search.query];
  refuted.insert(refuted.end(), repeating.begin(), repeating.end());
}

void SiteGrowth::verify() {
  for (const auto& site : sites_) static_cast<void>(site->map());  // not by several threads at once
  std::size_t done = 0;
  for (SessionSearch& search : grown_.searches) {
    progress_("looking whether places are there twice",
              static_cast<double>(done++) / static_cast<double>(grown_.searches.size()));
    if (!search.edges.empty()) verify(search);
  }
}

// Removes all fixes of a refuted session, and those that later sessions share with it.
void SiteGrowth::leave_out_refuted() {
  for (SessionSearch& search : grown_.searches) {
    std::erase_if(search.edges, [&](const SessionEdge& edge) {
      return std::find(refuted_now_.begin(), refuted_now_.end(), edge.reference) != refuted_now_.end();
    });
    const std::size_t left =
        std::accumulate(search.edges.begin(), search.edges.end(), std::size_t{0},
                        [](std::size_t sum, const SessionEdge& edge) { return sum + edge.held.size(); });
    if (left < options_.agreement.least) search.edges.clear();
  }
}

// Sessions that no edge connects any more become their own site.
void SiteGrowth::split() {
  for (const SessionSearch& search : grown_.searches) add_edges(grown_.edges, search.edges);
  std::vector<std::size_t> first(sessions_.size());
  std::iota(first.begin(), first.end(), 0U);
  for (const SessionEdge& edge : grown_.edges) {
    const std::size_t from = std::max(first[edge.reference], first[edge.query]);
    const std::size_t to = std::min(first[edge.reference], first[edge.query]);
    std::replace(first.begin(), first.end(), from, to);
  }
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    if (first[i] == i) grown_.groups.emplace_back();
    const auto group = std::find_if(grown_.groups.begin(), grown_.groups.end(),
                                    [&](const auto& g) { return (g.empty() ? i : g.front()) == first[i]; });
    group->push_back(i);
  }
}

}  // namespace

GrownSites grow_sites(const std::vector<Session>& sessions, const OverlapOptions& options, WorkerPool& workers,
                      const MergeProgress& progress) {
  return SiteGrowth(sessions, options, workers, progress).run();
}

}  // namespace gdtslam

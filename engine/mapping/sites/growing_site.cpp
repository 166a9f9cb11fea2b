#include "growing_site.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/mapping/adjust/pose_bins.hpp"
#include "engine/mapping/sites/site_graph.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {
namespace {

constexpr double kApart_m = 1.5;  // distance between places of a site that are searched
constexpr double kApart_rad = 0.8;
constexpr double kSpot_m = 2.0;                 // radius around another pose that fits as well
constexpr std::size_t kLeastFitting = 2;        // least number of places of a session that fit at the other spot,
constexpr std::size_t kFittingOverAgainst = 2;  // and least ratio to those that do not fit there
constexpr std::ptrdiff_t kLeastShared = 3;      // repeats that show the same

// Chooses one place for each spot and direction.
std::vector<std::size_t> places_apart(const Session& site) {
  std::vector<std::size_t> apart;
  for (const std::size_t place : site.places) {
    const Pose2& pose = site.poses[place];
    const bool is_known = std::any_of(apart.begin(), apart.end(), [&](std::size_t other) {
      return squared_distance(site.poses[other], pose) < kApart_m * kApart_m &&
             std::fabs(wrap_angle(site.poses[other].theta_rad - pose.theta_rad)) < kApart_rad;
    });
    if (!is_known) apart.push_back(place);
  }
  return apart;
}

std::vector<double> said_by(const std::vector<SessionEdge>& edges) {
  std::vector<double> said;
  for (const SessionEdge& edge : edges) {
    said.push_back(static_cast<double>(edge.reference));
    said.push_back(static_cast<double>(edge.query));
    said.push_back(static_cast<double>(edge.held.size()));
    for (const SessionFix& fix : edge.held) {
      const Pose2& T = fix.T_map_keyframe;
      for (const double value :
           {static_cast<double>(fix.keyframe), static_cast<double>(fix.reference_place), T.x_m, T.y_m, T.theta_rad}) {
        said.push_back(value);
      }
    }
  }
  return said;
}

}  // namespace

SiteRepeats::SiteRepeats(const Session& site, const SessionMap& map, WorkerPool& workers) : map_(map) {
  const std::vector<std::size_t> places = places_apart(site);
  std::vector<std::optional<Pose2>> found(places.size());
  workers.run(places.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t k = begin; k < end; ++k) {
      found[k] = map.find_elsewhere(site, places[k], site.poses[places[k]]);
    }
  });
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (found[k]) repeats_.push_back({.T_site_spot = *found[k], .T_site_twin = site.poses[places[k]]});
  }
  tell_shared_ones();
}

// Each repeat also holds in reverse: the twin looks like the spot.
void SiteRepeats::tell_shared_ones() {
  std::vector<Repeat> turned_round;
  for (Repeat& repeat : repeats_) {
    const Pose2 T_twin_spot = repeat.T_site_twin * inverse(repeat.T_site_spot);
    const auto alike = std::count_if(repeats_.begin(), repeats_.end(), [&](const Repeat& other) {
      return ExcludedPoses{other.T_site_twin}.hold(T_twin_spot * other.T_site_spot);
    });
    repeat.is_shared = alike >= kLeastShared;
    if (repeat.is_shared) turned_round.push_back({repeat.T_site_twin, repeat.T_site_spot, true});
  }
  repeats_.insert(repeats_.end(), turned_round.begin(), turned_round.end());
}

// Other poses of the query: by spots that the site has twice, and by repeats of the building.
std::vector<SiteRepeats::Way> SiteRepeats::other_ways(const Session& query, const Pose2& T_site_query) const {
  std::vector<Way> ways;
  for (const Repeat& repeat : repeats_) {
    const auto is_there = [&](std::size_t place) {
      return squared_distance(repeat.T_site_spot, T_site_query * query.poses[place]) < kSpot_m * kSpot_m;
    };
    const auto there = std::find_if(query.places.begin(), query.places.end(), is_there);
    if (there == query.places.end() && !repeat.is_shared) continue;
    const Pose2& seen = query.poses[there == query.places.end() ? query.places.front() : *there];
    const Way way{repeat.T_site_twin * between(repeat.T_site_spot, T_site_query), repeat.is_shared};
    const bool is_known = std::any_of(ways.begin(), ways.end(), [&](const Way& known) {
      return known.is_shared == way.is_shared && ExcludedPoses{known.T_site_query * seen}.hold(way.T_site_query * seen);
    });
    if (!is_known) ways.push_back(way);
  }
  return ways;
}

bool SiteRepeats::is_possible(const Session& query, const Way& way) const {
  std::size_t fitting = 0;
  std::size_t against = 0;
  for (const std::size_t place : query.places) {
    switch (map_.test_walls(query, place, way.T_site_query * query.poses[place])) {
      case SessionMap::Test::kElsewhere:
        break;
      case SessionMap::Test::kFits:
        ++fitting;
        break;
      case SessionMap::Test::kDoesNotFit:
        ++against;
        break;
    }
  }
  const bool is_there_too = fitting >= kLeastFitting && fitting >= kFittingOverAgainst * against;
  const bool is_unseen = way.is_shared && against == 0;
  return (is_there_too || is_unseen) && !map_.has_walls_in_the_way(query, way.T_site_query);
}

bool SiteRepeats::may_lie_elsewhere(const Session& query, const Pose2& T_site_query) const {
  const std::vector<Way> ways = other_ways(query, T_site_query);
  return std::any_of(ways.begin(), ways.end(), [&](const Way& way) { return is_possible(query, way); });
}

void add_edges(std::vector<SessionEdge>& edges, const std::vector<SessionEdge>& more) {
  for (const SessionEdge& edge : more) {
    const auto same = std::find_if(edges.begin(), edges.end(), [&](const SessionEdge& e) {
      return e.reference == edge.reference && e.query == edge.query;
    });
    if (same == edges.end()) {
      edges.push_back(edge);
    } else {
      same->held.insert(same->held.end(), edge.held.begin(), edge.held.end());
    }
  }
}

GrowingSite::GrowingSite(std::vector<std::size_t> group, const std::vector<Session>& sessions,
                         std::vector<SessionEdge> edges, const SessionSearchOptions& options)
    : group_(std::move(group)), sessions_(sessions), edges_(std::move(edges)), options_(options) {}

bool GrowingSite::holds(std::size_t session) const { return std::binary_search(group_.begin(), group_.end(), session); }

const SessionMap& GrowingSite::map() {
  if (!map_) map_ = std::make_unique<SessionMap>(whole(), options_);
  return *map_;
}

const Session& GrowingSite::whole() {
  if (group_.size() == 1) return sessions_[group_.front()];
  if (!whole_) whole_ = std::make_unique<Session>(SiteGraph(group_, sessions_, edges_).as_one());
  return *whole_;
}

const SiteRepeats& GrowingSite::repeats(WorkerPool& workers) {
  if (!repeats_) repeats_ = std::make_unique<SiteRepeats>(whole(), map(), workers);
  return *repeats_;
}

Pose2 GrowingSite::T_site_keyframe(std::size_t session, std::size_t keyframe) {
  std::size_t before = 0;
  for (const std::size_t k : group_) {
    if (k == session) break;
    before += sessions_[k].scans.size();
  }
  return whole().poses[before + keyframe];
}

SessionEdge GrowingSite::make_edge(std::size_t query, SessionFix fix) {
  std::size_t place = fix.reference_place;
  auto session = group_.begin();
  for (; place >= sessions_[*session].places.size(); ++session) place -= sessions_[*session].places.size();
  const Session& reference = sessions_[*session];
  const Pose2& T_site_place = whole().poses[whole().places[fix.reference_place]];
  fix.T_map_keyframe = reference.poses[reference.places[place]] * between(T_site_place, fix.T_map_keyframe);
  fix.T_map_elsewhere.reset();
  fix.reference_place = place;
  return {*session, query, {fix}};
}

const SessionOverlap& KnownOverlaps::of(GrowingSite& site, const Session& query, std::size_t number,
                                        const OverlapOptions& options, WorkerPool& workers) {
  Key key{number, site.group(), said_by(site.edges())};
  const auto known = known_.find(key);
  if (known != known_.end()) return known->second;
  return known_.emplace(std::move(key), find_overlap(site.map(), query, options, workers)).first->second;
}

}  // namespace gdtslam

#include "growing_site.hpp"

#include <algorithm>
#include <utility>

#include "engine/mapping/sessions/site_graph.hpp"

namespace gdtslam {
namespace {

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

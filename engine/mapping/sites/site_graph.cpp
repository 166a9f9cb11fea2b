#include "site_graph.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "engine/mapping/loops/loop_closer.hpp"
#include "engine/mapping/sites/site_growth.hpp"

namespace gdtslam {
namespace {

// Weights of a session's path after its own adjustment: each step counts as much as a match, and stretches count as the
// front end's do in the adjustment of one drive.
constexpr std::size_t kHeldSpans[] = {1, 4, 12, 30};  // keyframes
constexpr std::size_t kHeldOver = 4;                  // spans of each length that cover a step, which is to count once
constexpr double kHeldNoise_m = 0.01;
constexpr double kHeldNoise_rad = 0.003;
constexpr std::size_t kMostSolved = 400;  // places with computed covariances; the rest are interpolated

// The fix with the largest overlap among those held.
const SessionFix& best_fix(const std::vector<SessionFix>& fixes) {
  return *std::max_element(fixes.begin(), fixes.end(), [](const SessionFix& a, const SessionFix& b) {
    return a.evidence.overlap < b.evidence.overlap;
  });
}

// The place that is this keyframe, or the last one before it.
std::size_t place_before(const Session& session, std::size_t keyframe) {
  const auto next = std::upper_bound(session.places.begin(), session.places.end(), keyframe);
  return static_cast<std::size_t>(next - session.places.begin()) - 1;
}

// Relation from the later to the earlier node: the same measurement, its tangent seen from there.
PoseRelation turned_round(const PoseRelation& relation) {
  const Matrix3 back = adjoint_matrix(inverse(relation.T_from_to));
  return {.from = relation.to,
          .to = relation.from,
          .T_from_to = inverse(relation.T_from_to),
          .information = transposed_times(back, relation.information * back)};
}

}  // namespace

SiteGraph::SiteGraph(const std::vector<std::size_t>& group, const std::vector<Session>& sessions,
                     const std::vector<SessionEdge>& edges) {
  for (const std::size_t number : group) add(sessions[number], number);
  lay(sessions, edges);
}

std::size_t SiteGraph::part_index(std::size_t session) const {
  const auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.session == session; });
  return static_cast<std::size_t>(part - parts_.begin());
}

const SiteGraph::Part& SiteGraph::part_of_place(std::size_t place) const {
  return *std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return place < p.first_place + p.places; });
}

void SiteGraph::add(const Session& session, std::size_t number) {
  const Part part{number, scans_.size(), session.scans.size(), places_.size(), session.places.size()};
  const double before_m = path_m_.empty() ? 0.0 : path_m_.back() + kBetweenDrives_m;
  scans_.insert(scans_.end(), session.scans.begin(), session.scans.end());
  poses_.insert(poses_.end(), session.poses.begin(), session.poses.end());
  shape_.insert(shape_.end(), session.poses.begin(), session.poses.end());
  for (const double path_m : session.path_m) path_m_.push_back(before_m + path_m);
  doubts_.insert(doubts_.end(), session.doubts.begin(), session.doubts.end());
  doubts_.resize(scans_.size());
  for (const std::size_t place : session.places) places_.push_back(part.first_keyframe + place);
  const auto moved = [&](PoseRelation relation) {
    relation.from += part.first_place;
    relation.to += part.first_place;
    return relation;
  };
  for (const PoseRelation& relation : session.path) graph_.path.push_back(moved(relation));
  for (const Loop& loop : session.loops) graph_.loops.push_back({moved(loop.relation), loop.weight});
  parts_.push_back(part);
}

// Starts at the first session and adds sessions that overlap with one already laid, each time by the pair with the most
// fixes; its best fix joins the path, all others are loops.
void SiteGraph::lay(const std::vector<Session>& sessions, const std::vector<SessionEdge>& edges) {
  std::vector<bool> is_laid(parts_.size());
  is_laid.front() = true;
  const auto is_of_site = [&](const SessionEdge& edge) { return part_index(edge.reference) < parts_.size(); };
  for (std::size_t laid = 1; laid < parts_.size(); ++laid) {
    const SessionEdge* next = nullptr;
    for (const SessionEdge& edge : edges) {
      if (!is_of_site(edge) || is_laid[part_index(edge.reference)] == is_laid[part_index(edge.query)]) continue;
      if (next == nullptr || edge.held.size() > next->held.size()) next = &edge;
    }
    const SessionFix& fix = best_fix(next->held);
    const Session& query = sessions[next->query];
    const Pose2 T_reference_query = fix.T_map_keyframe * inverse(query.poses[fix.keyframe]);
    const bool is_query_new = is_laid[part_index(next->reference)];
    const std::size_t added = part_index(is_query_new ? next->query : next->reference);
    const std::size_t known = part_index(is_query_new ? next->reference : next->query);
    const Part& there = parts_[known];
    const Pose2 T_site_known = poses_[there.first_keyframe] * inverse(shape_[there.first_keyframe]);
    const Pose2 T_site_added = T_site_known * (is_query_new ? T_reference_query : inverse(T_reference_query));
    const Part& part = parts_[added];
    for (std::size_t i = part.first_keyframe; i < part.first_keyframe + part.keyframes; ++i) {
      poses_[i] = T_site_added * shape_[i];
    }
    is_laid[added] = true;
    add_edge(*next, sessions, true);
  }
  for (const SessionEdge& edge : edges) {
    if (is_of_site(edge)) add_edge(edge, sessions, false);
  }
  for (const std::size_t place : places_) graph_.poses.push_back(poses_[place]);
  if (parts_.size() == 1) return;
  graph_.optimise(true);
  carry_keyframes();
}

// A trusted edge adds its best fix to the path; otherwise all its fixes are loops.
void SiteGraph::add_edge(const SessionEdge& edge, const std::vector<Session>& sessions, bool is_trusted) {
  const Session& reference = sessions[edge.reference];
  const Session& query = sessions[edge.query];
  const SessionFix& best = best_fix(edge.held);
  for (const SessionFix& fix : edge.held) {
    if (is_trusted && &fix != &best) continue;
    const std::size_t place = place_before(query, fix.keyframe);
    const Pose2 T_map_place = fix.T_map_keyframe * between(query.poses[fix.keyframe], query.poses[query.places[place]]);
    const PoseRelation relation{
        .from = parts_[part_index(edge.reference)].first_place + fix.reference_place,
        .to = parts_[part_index(edge.query)].first_place + place,
        .T_from_to = between(reference.poses[reference.places[fix.reference_place]], T_map_place),
        .information = loop_information(fix.evidence)};
    const PoseRelation onward = relation.from < relation.to ? relation : turned_round(relation);
    if (is_trusted) {
      graph_.path.push_back(onward);
    } else {
      graph_.loops.push_back({onward, 1.0});
    }
  }
}

void SiteGraph::show_to(LoopFinder& finder) {
  finder.extend({scans_, poses_, path_m_, doubts_});
  for (const std::size_t place : places_) finder.add_place(place);
}

void SiteGraph::close_loops(LoopFinder& finder, WorkerPool& workers, const std::function<void(double)>& progress) {
  finder.look_at(graph_, 1, places_.size(), workers, [&](std::size_t here, const std::vector<Loop>& loops) {
    for (const Loop& loop : loops) take_loop(graph_.loops, loop);
    progress(static_cast<double>(here) / static_cast<double>(places_.size()));
    return !loops.empty();
  });
  graph_.optimise(true);
  carry_keyframes();
  finder.forget_bent();
}

// Moves the keyframes in place, because the finder refers to them.
void SiteGraph::carry_keyframes() {
  for (const Part& part : parts_) {
    std::vector<std::size_t> places;
    places.reserve(part.places);
    for (std::size_t i = 0; i < part.places; ++i) places.push_back(places_[part.first_place + i] - part.first_keyframe);
    carry_keyframes_between(places, std::span(graph_.poses).subspan(part.first_place, part.places),
                            std::span(shape_).subspan(part.first_keyframe, part.keyframes),
                            std::span(poses_).subspan(part.first_keyframe, part.keyframes));
  }
}

// Relations of each drive (a session may be a site of several, which only the scans distinguish), and the active loops:
// passes may be too far apart for their points to constrain each other.
std::vector<PoseRelation> SiteGraph::held_relations() const {
  std::vector<PoseRelation> held;
  const Matrix3 information =
      1.0 / static_cast<double>(kHeldOver * std::size(kHeldSpans)) *
      Matrix3::diagonal(1.0 / square(kHeldNoise_m), 1.0 / square(kHeldNoise_m), 1.0 / square(kHeldNoise_rad));
  for (const Part& part : parts_) {
    const std::size_t end = part.first_keyframe + part.keyframes;
    for (const std::size_t span : kHeldSpans) {
      const std::size_t step = std::max<std::size_t>(1, span / kHeldOver);
      for (std::size_t i = part.first_keyframe; i + span < end; i += step) {
        if (path_m_[i + span] - path_m_[i] >= kBetweenDrives_m) continue;
        held.push_back({i, i + span, between(shape_[i], shape_[i + span]), information});
      }
    }
  }
  for (const Loop& loop : graph_.loops) {
    const PoseRelation& joint = loop.relation;
    if (!loop.is_on()) continue;
    held.push_back({places_[joint.from], places_[joint.to], joint.T_from_to, loop.weight * joint.information});
  }
  return held;
}

std::size_t SiteGraph::loops_between(bool is_on) const {
  return static_cast<std::size_t>(std::count_if(graph_.loops.begin(), graph_.loops.end(), [&](const Loop& loop) {
    return loop.is_on() == is_on && &part_of_place(loop.relation.from) != &part_of_place(loop.relation.to);
  }));
}

void SiteGraph::return_to_frame() {
  const Pose2 back = shape_.front() * inverse(poses_.front());
  for (Pose2& pose : poses_) pose = back * pose;
  for (Pose2& pose : graph_.poses) pose = back * pose;
}

Session SiteGraph::as_one() && {
  Session session;
  session.scans = std::move(scans_);
  session.poses = std::move(poses_);
  session.path_m = std::move(path_m_);
  session.places = std::move(places_);
  session.doubts = std::move(doubts_);
  return session;
}

std::vector<std::vector<Pose2>> SiteGraph::poses_of_sessions() const {
  std::vector<std::vector<Pose2>> all;
  all.reserve(parts_.size());
  for (const Part& part : parts_) {
    const auto first = poses_.begin() + static_cast<std::ptrdiff_t>(part.first_keyframe);
    all.emplace_back(first, first + static_cast<std::ptrdiff_t>(part.keyframes));
  }
  return all;
}

std::vector<Matrix3> SiteGraph::covariances() const {
  std::vector<std::size_t> nodes;
  for (std::size_t i = 0; i < places_.size(); i += places_.size() / kMostSolved + 1) nodes.push_back(i);
  if (nodes.back() + 1 < places_.size()) nodes.push_back(places_.size() - 1);
  std::vector<std::size_t> at;
  at.reserve(nodes.size());
  for (const std::size_t node : nodes) at.push_back(places_[node]);
  return spread_covariances(at, covariances_in_map(graph_, nodes), poses_.size());
}

}  // namespace gdtslam

#include "loop_closer.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/memory/sparing.hpp"
#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {
namespace {

bool is_tied(const PoseGraph& graph, std::size_t place) {
  return std::any_of(graph.loops.begin(), graph.loops.end(), [&](const Loop& loop) {
    return loop.is_on() && (loop.relation.from == place || loop.relation.to == place);
  });
}

constexpr double kHeldShare = 0.8;  // share of the loops that must stay on when the path's weights change
constexpr double kLess = 4.0;       // factor of the variance
constexpr int kMostTimesLess = 4;
// One standard deviation of the bias of unknown wheels.
constexpr double kUsualDistance = 0.1;
constexpr double kUsualTurn = 0.1;
constexpr double kUsualTurn_rad_per_m = 0.1;
constexpr int kGraduatedEvery = 8;  // places with loops between two solutions that start from wide kernels

std::size_t loops_on(const PoseGraph& graph) {
  return static_cast<std::size_t>(
      std::count_if(graph.loops.begin(), graph.loops.end(), [](const Loop& loop) { return loop.is_on(); }));
}

}  // namespace

void carry_keyframes_between(std::span<const std::size_t> places, std::span<const Pose2> of_places,
                             std::span<const Pose2> shape, std::span<Pose2> poses) {
  for (std::size_t place = 0; place < of_places.size(); ++place) {
    const std::size_t from = places[place];
    const bool is_last = place + 1 == of_places.size();
    const std::size_t to = is_last ? poses.size() : places[place + 1];
    for (std::size_t i = from; i < to; ++i) poses[i] = of_places[place] * between(shape[from], shape[i]);
    if (is_last) break;
    const Pose2 end = of_places[place] * between(shape[from], shape[to]);
    const Tangent2 off = log_tangent(between(end, of_places[place + 1]));
    for (std::size_t i = from + 1; i < to; ++i) {
      const double share = static_cast<double>(i - from) / static_cast<double>(to - from);
      const Tangent2 here = adjoint_matrix(between(shape[i], shape[to])) * off;
      poses[i] = poses[i] * exp_tangent({share * here[0], share * here[1], share * here[2]});
    }
  }
}

std::size_t PlacePruning::kept_beside(const PoseGraph& graph, std::size_t place) const {
  return static_cast<std::size_t>(std::count_if(kept_.begin(), kept_.end(), [&](std::size_t other) {
    const Pose2 T = between(graph.poses[other], graph.poses[place]);
    return translation_length(T) < rules_.near_m && std::fabs(T.theta_rad) < rules_.near_rad;
  }));
}

std::optional<std::size_t> PlacePruning::next(const PoseGraph& graph) {
  if (graph.poses.size() <= rules_.places_later) return std::nullopt;
  const std::size_t place = graph.poses.size() - 1 - rules_.places_later;
  if (is_crowded(graph, place) && is_tied(graph, place)) return place;
  push_sparingly(kept_, place);
  return std::nullopt;
}

bool PlaceCounter::is_place(double path_m) {
  ++since_last_;
  if (places_ > 0 && path_m - last_m_ < options_.place_every_m && since_last_ < options_.most_between) return false;
  ++places_;
  since_last_ = 0;
  last_m_ = path_m;
  return true;
}

LoopCloser::LoopCloser(const FrontEndPath& path, const LoopOptions& options)
    : path_(path),
      options_(options),
      counter_(options),
      measured_(path, {}),
      finder_(options.search),
      pruning_(options.pruning) {
  graph_.bias_information =
      Matrix3::diagonal(1.0 / square(kUsualDistance), 1.0 / square(kUsualTurn), 1.0 / square(kUsualTurn_rad_per_m));
}

bool LoopCloser::take_loops(const std::vector<Loop>& loops) {
  for (const Loop& loop : loops) take_loop(graph_.loops, loop);
  return !loops.empty();
}

// Keyframes after this one are hidden from the search, so that the path may be taken in one piece or in many.
void LoopCloser::take_keyframe() {
  const std::size_t here = known_++;
  finder_.extend({path_.scans, std::span(path_.poses).first(known_), std::span(path_.path_m).first(known_),
                  std::span(path_.doubts).first(std::min(known_, path_.doubts.size()))});
  if (!counter_.is_place(path_.path_m[here])) return;
  measured_.add_place(here);
  finder_.add_place(here);
  if (places().size() == 1) return;
  const std::size_t place = places().size() - 1;
  coming_.emplace_back(measured_.by_front_end(place), measured_.by_wheels(place));
}

void LoopCloser::follow_place(std::size_t here, WorkerPool& workers) {
  if (here == 0) {
    graph_.poses = {path_.poses.front()};
    return;
  }
  push_sparingly(graph_.path, coming_.front().first);
  push_sparingly(graph_.wheels, coming_.front().second);
  coming_.pop_front();
  push_sparingly(graph_.poses, graph_.poses.back() * graph_.path.back().T_from_to);
  const std::size_t most = pruning_.is_crowded(graph_, here) ? 1 : options_.search.revisits.most;
  if (!take_loops(finder_.look(graph_, here, most, workers))) return;
  graph_.optimise(++closed_ % kGraduatedEvery == 0);
  T_closed_front_ = graph_.poses[here] * inverse(path_.poses[places()[here]]);
}

void LoopCloser::follow(const Progress& progress, WorkerPool& workers) {
  while (known_ < path_.poses.size()) {
    take_keyframe();
    const std::size_t here = graph_.poses.size();
    if (places().size() <= here + kPlacesAround) continue;
    follow_place(here, workers);
    prune();
    if (here > 0) progress(static_cast<double>(places()[here]) / static_cast<double>(path_.poses.size()), 0);
  }
}

// The keyframes from a place to the next one are pruned with it.
void LoopCloser::prune() {
  const std::optional<std::size_t> place = pruning_.next(graph_);
  if (!place) return;
  finder_.leave_out(*place);
  for (std::size_t i = places()[*place]; i < places()[*place + 1]; ++i) pruned_.push_back(i);
}

void LoopCloser::go_round(const Progress& progress, int round, WorkerPool& workers) {
  finder_.look_at(graph_, 1, places().size(), workers, [&](std::size_t here, const std::vector<Loop>& loops) {
    const bool has_changed = take_loops(loops);
    progress(static_cast<double>(here) / static_cast<double>(places().size()), round);
    return has_changed;
  });
  graph_.optimise(true);
  carry_keyframes();
}

// Wheels and front end are weighted by the loops. If that would switch off loops that hold with the stated weights, the
// loops are worse than stated: then both sources get larger variances, in the same ratio.
void LoopCloser::weigh_sources() {
  const std::size_t held = loops_on(graph_);
  const PoseGraph as_stated = graph_;
  measured_.weigh(graph_);
  for (int times = 0; times <= kMostTimesLess; ++times) {
    graph_ = as_stated;
    graph_.path = measured_.matches();
    graph_.wheels = measured_.wheels();
    graph_.optimise(true);
    if (static_cast<double>(loops_on(graph_)) >= kHeldShare * static_cast<double>(held)) return;
    measured_.believe_less(kLess);
  }
  measured_.believe_as_stated();
  graph_ = as_stated;
}

std::vector<Pose2> LoopCloser::carried_keyframes() const {
  std::vector<Pose2> poses(path_.poses.begin(), path_.poses.begin() + static_cast<std::ptrdiff_t>(known_));
  carry_keyframes_between(places(), graph_.poses, path_.poses, poses);
  return poses;
}

void LoopCloser::carry_keyframes() {
  poses_ = carried_keyframes();
  finder_.extend({path_.scans, poses_, path_.path_m, path_.doubts});
  finder_.forget_bent();
}

void LoopCloser::run(const Progress& progress, WorkerPool& workers) {
  follow(progress, workers);
  for (std::size_t here = graph_.poses.size(); here < places().size(); ++here) {
    follow_place(here, workers);
    if (here > 0) progress(static_cast<double>(places()[here]) / static_cast<double>(path_.poses.size()), 0);
  }
  poses_ = path_.poses;
  if (places().size() < 2) return;
  graph_.optimise(true);
  carry_keyframes();
  for (int round = 1; round <= options_.rounds; ++round) go_round(progress, round, workers);
  finder_.end();
  measured_.correct_wheels(graph_);
  measured_.state_wheel_noise(poses_);
  weigh_sources();
  measured_.correct_wheels(graph_);
  carry_keyframes();
}

}  // namespace gdtslam

#include "loop_closer.hpp"

#include <algorithm>

namespace gdtslam {
namespace {

constexpr double kHeldShare = 0.8;  // of the loops that were on, to stay on with other weights of the path
constexpr double kLess = 4.0;       // times the variance
constexpr int kMostTimesLess = 4;
constexpr int kGraduatedEvery = 8;  // places with loops, after which the graph is solved from wide kernels on

std::vector<std::size_t> places_along(const std::vector<double>& path_m, const LoopOptions& options) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < path_m.size(); ++i) {
    if (places.empty() || path_m[i] - path_m[places.back()] >= options.place_every_m ||
        i - places.back() >= options.most_between) {
      places.push_back(i);
    }
  }
  return places;
}

std::size_t loops_on(const PoseGraph& graph) {
  return static_cast<std::size_t>(
      std::count_if(graph.loops.begin(), graph.loops.end(), [](const Loop& loop) { return loop.is_on(); }));
}

// A loop that is there already is found again from a better start: the new one takes its place.
void take(std::vector<Loop>& loops, const Loop& loop) {
  const auto same = std::find_if(loops.begin(), loops.end(), [&](const Loop& known) {
    return known.relation.from == loop.relation.from && known.relation.to == loop.relation.to;
  });
  if (same == loops.end()) {
    loops.push_back(loop);
  } else {
    *same = loop;
  }
}

}  // namespace

LoopCloser::LoopCloser(const FrontEndPath& path, const LoopOptions& options)
    : path_(path),
      options_(options),
      poses_(path.poses),
      measured_(path, places_along(path.path_m, options)),
      finder_({path.scans, poses_, path.path_m}, measured_.places(), options.search) {}

bool LoopCloser::take_loops(PoseGraph& graph, std::size_t here) {
  const std::vector<Loop> loops = finder_.look(graph, here);
  for (const Loop& loop : loops) take(graph.loops, loop);
  return !loops.empty();
}

void LoopCloser::follow_the_path(const Progress& progress) {
  int closed = 0;
  graph_.poses = {poses_.front()};
  for (std::size_t here = 1; here < places().size(); ++here) {
    graph_.path.push_back(measured_.by_front_end(here));
    graph_.poses.push_back(graph_.poses.back() * graph_.path.back().T_from_to);
    if (take_loops(graph_, here)) graph_.optimise(++closed % kGraduatedEvery == 0);
    progress(static_cast<double>(here) / static_cast<double>(places().size()), 0);
  }
  graph_.optimise(true);
  carry_keyframes();
}

void LoopCloser::go_round(const Progress& progress, int round) {
  for (std::size_t here = 1; here < places().size(); ++here) {
    take_loops(graph_, here);
    progress(static_cast<double>(here) / static_cast<double>(places().size()), round);
  }
  graph_.optimise(true);
  carry_keyframes();
}

// Wheels and front end are believed as the loops say. Where that would switch off loops that hold with what was stated,
// loops are worse than they say: both are believed less then, in the same ratio.
void LoopCloser::weigh_sources() {
  const std::size_t held = loops_on(graph_);
  const PoseGraph as_stated = graph_;
  measured_.weigh(graph_.loops);
  for (int times = 0; times <= kMostTimesLess; ++times) {
    graph_ = as_stated;
    graph_.path = measured_.relations();
    graph_.optimise(true);
    if (static_cast<double>(loops_on(graph_)) >= kHeldShare * static_cast<double>(held)) return;
    measured_.believe_less(kLess);
  }
  measured_.believe_as_stated();
  graph_ = as_stated;
}

// Between two places the path keeps its shape; what the graph moved its end by is spread over it.
void LoopCloser::carry_keyframes() {
  const std::vector<Pose2>& shape = path_.poses;
  for (std::size_t place = 0; place < places().size(); ++place) {
    const std::size_t from = places()[place];
    const bool is_last = place + 1 == places().size();
    const std::size_t to = is_last ? shape.size() : places()[place + 1];
    for (std::size_t i = from; i < to; ++i) poses_[i] = graph_.poses[place] * between(shape[from], shape[i]);
    if (is_last) break;
    const Pose2 end = graph_.poses[place] * between(shape[from], shape[to]);
    const Tangent2 off = log_tangent(between(end, graph_.poses[place + 1]));
    for (std::size_t i = from + 1; i < to; ++i) {
      const double share = static_cast<double>(i - from) / static_cast<double>(to - from);
      const Tangent2 here = adjoint_matrix(between(shape[i], shape[to])) * off;
      poses_[i] = poses_[i] * exp_tangent({share * here[0], share * here[1], share * here[2]});
    }
  }
  finder_.forget_bent();
}

void LoopCloser::run(const Progress& progress) {
  if (places().size() < 2) {
    graph_.poses.assign(poses_.begin(), poses_.begin() + static_cast<std::ptrdiff_t>(places().size()));
    return;
  }
  follow_the_path(progress);
  for (int round = 1; round <= options_.rounds; ++round) go_round(progress, round);
  measured_.correct_wheels(poses_);
  weigh_sources();
  carry_keyframes();
}

}  // namespace gdtslam

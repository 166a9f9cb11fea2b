#include "place_pruning.hpp"

#include <algorithm>
#include <cmath>
#include "engine/core/memory/sparing.hpp"

namespace gdtslam {
namespace {

bool is_tied(const PoseGraph& graph, std::size_t place) {
  return std::any_of(graph.loops.begin(), graph.loops.end(), [&](const Loop& loop) {
    return loop.is_on() && (loop.relation.from == place || loop.relation.to == place);
  });
}

}  // namespace

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

}  // namespace gdtslam

// Places to which the robot may have come back: the earlier places that a pose graph has near a later one, within its
// own uncertainty. Thread-safe. Cost: a solution of the graph's factor for each place nearby.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// An earlier place that may be near the current one, and the graph's uncertainty of the relative pose.
struct Revisit {
  std::size_t place = 0;
  Pose2 T_place_here;
  double sigma_m = 0.0;  ///< in the least sure direction
  double sigma_rad = 0.0;
};

/// Which revisits are worth a search.
struct RevisitRules {
  double least_path_m = 16.0;  ///< path length in between
  double near_m = 5.0;         ///< two stretches this near see the same walls
  double widest_m = 40.0;      ///< largest half window: a less certain place is searched later, when the graph is surer
  double sigmas = 3.0;         ///< half of a window in standard deviations, plus the next two
  double least_half_m = 0.3;
  double least_half_rad = 0.05;
  double stretch_m = 6.0;  ///< path length within which the nearest place alone counts
  std::size_t most = 4;

  [[nodiscard]] double half_m(const Revisit& revisit) const;
  [[nodiscard]] double half_rad(const Revisit& revisit) const;
};

/// Finds the revisits of node `here` among the nodes before it, the likeliest and surest first. `path_m` has the path
/// length up to each node; `left_out` marks nodes that are not searched (missing entries count as false).
std::vector<Revisit> find_revisits(const PoseGraph& graph, const GraphCovariance& covariance,
                                   std::span<const double> path_m, std::size_t here, const RevisitRules& rules = {},
                                   const std::vector<bool>& left_out = {});

}  // namespace gdtslam

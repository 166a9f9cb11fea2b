// Replays the growth of a graph. The path is extended place by place by its measured steps. At each place with loops,
// the places so far are solved with all loops known by then, each with its final weight. Frame: the graph's; the first
// place is held fixed. The same bits on every host. Thread-safe. Cost: a few factorisations a stage
// (block_cholesky.hpp).
#pragma once

#include <cstddef>
#include <vector>

#include "pose_graph.hpp"

namespace gdtslam {

/// The graph when the loops that end at this place become known.
struct ReplayStage {
  std::size_t place = 0;           ///< place of the robot in this stage
  std::vector<std::size_t> loops;  ///< indices of these loops among the graph's
  /// Poses of all places: by least squares up to `place`, by the measured path after it.
  std::vector<Pose2> poses;
  /// Covariances of the robot at `place` and of every place up to that of the next stage, in the tangent of its pose as
  /// seen from the first place.
  std::vector<Matrix3> covariances;
};

/// Returns stage 0, the measured path without loops, and then at most `most_stages` stages in the order of the path. If
/// loops end at more places than that, neighbouring places share a stage. `graph` must have a path relation from each
/// place to the next. The first relation of a pair extends the path; any others are further evidence. Of the graph's
/// poses only the first is used.
std::vector<ReplayStage> replay_graph(const PoseGraph& graph, std::size_t most_stages);

}  // namespace gdtslam

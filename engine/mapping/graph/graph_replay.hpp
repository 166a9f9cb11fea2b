// A graph as it grew: the path is driven from place to place as it was measured, and where loops lead back the places
// driven so far are solved with all loops known by then, each as far as it is believed in the end. Frame: the graph's,
// the first place held. The same bits on every host. Thread-safe. Cost: a few factorisations a stage
// (block_cholesky.hpp).
#pragma once

#include <cstddef>
#include <vector>

#include "pose_graph.hpp"

namespace gdtslam {

/// From here on some more loops are known.
struct ReplayStage {
  std::size_t place = 0;           ///< place of the robot in this stage
  std::vector<std::size_t> loops;  ///< which loops, as indices into the graph's
  /// Poses of all places: up to `place` by least squares, the others as the path was measured from there.
  std::vector<Pose2> poses;
  /// Covariances of the robot at `place` and of every place up to that of the next stage, in the tangent of its pose as
  /// seen from the first place.
  std::vector<Matrix3> covariances;
};

/// The path as it was measured without any loop, which is stage 0, then the stages in the order of the path, at most
/// `most_stages` of them: where later places of loops are more, neighbouring ones share a stage. `graph` has a relation
/// of its path from each place to the next, the first of them being the one that is driven, others beside it as
/// further evidence; its poses but the first count for nothing.
std::vector<ReplayStage> replay_graph(const PoseGraph& graph, std::size_t most_stages);

}  // namespace gdtslam

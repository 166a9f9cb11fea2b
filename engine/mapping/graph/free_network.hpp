// How sure each pose of a graph is within the map as a whole. A graph tells only how poses lie to each other; held at
// its first pose, the last ones look bad whatever is in between. Here no pose is held: what is left once the best rigid
// motion of all is taken out, which is what a map laid over the truth shows (inner constraints [Baarda1973]). Frame:
// map. Thread-safe. Cost: for each node asked for three solutions of the graph's system, and some products with every
// other.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pose_graph.hpp"

namespace gdtslam {

/// Returns the covariances of (x, y, theta) along the map's axes, one a node asked for; the rigid motion is that of
/// these nodes' positions.
std::vector<Matrix3> covariances_in_map(const PoseGraph& graph, std::span<const std::size_t> nodes);

/// For `count` indices, the covariances that are known at some of them, ascending, and between two of these linearly;
/// beyond the last as there.
std::vector<Matrix3> spread_covariances(std::span<const std::size_t> at, std::span<const Matrix3> known,
                                        std::size_t count);

}  // namespace gdtslam

// Decides whether two groups of scans fit as a second visit would: walls seen from the same side, and no wall of one in
// the free space of the other. Thread-safe; linear in the points.
#pragma once

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/loops/scan_group.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Evidence for and against a loop.
struct LoopEvidence {
  double overlap = 0.0;        ///< share of the query's wall points on a wall seen from the same side
  double turned = 0.0;         ///< share of the points on any wall whose wall was seen from the other side alone
  double contradiction = 0.0;  ///< share of the points in known cells of the other group that lie in its free space
  Matrix3 shape{};  ///< surface_shape() for one point of the walls that both groups have, in the query's frame
  Matrix3 doubt{};  ///< covariance of the relative pose that comes from errors of the groups' own keyframes
};

/// Conditions for a loop to enter the graph, which makes the final decision. They are lenient: a graph can switch off a
/// wrong loop, but cannot find a loop that it never had.
struct LoopLimits {
  double least_overlap = 0.3;
  double most_turned = 0.1;
  double most_contradiction = 0.08;
};

LoopEvidence weigh_loop(const ScanGroup& reference, const ScanGroup& query, const Pose2& T_reference_query);
bool is_possible(const LoopEvidence& evidence, const LoopLimits& limits = {});

/// Information of the relative pose of two groups, from the walls that both have seen: a wall across the way that only
/// one has seen gives no information about the way. Never better than matching with a distance field of some
/// centimetres.
Matrix3 loop_information(const LoopEvidence& evidence);

}  // namespace gdtslam

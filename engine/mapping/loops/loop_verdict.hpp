// Whether one group of scans lies on another as a second visit would: walls seen from the same side, none where beams
// went through, either way. Thread-safe; linear in the points.
#pragma once

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/loops/scan_group.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// What speaks for and against a loop.
struct LoopEvidence {
  double overlap = 0.0;        ///< share of the query's wall points on a wall that is seen from the same side
  double turned = 0.0;         ///< share of those on any wall that lie on one seen from the other side alone
  double contradiction = 0.0;  ///< share of what is known, where a wall of one is free space of the other
  Matrix3 shape{};             ///< shape_of() for one point of the query's walls that both have, in the query's frame
  Matrix3 doubt{};             ///< covariance of where the groups' keyframes lie, as it comes to the relative pose
};

/// What a loop needs to be taken into the graph, which then decides. Lenient: a graph can switch off what is wrong, and
/// cannot find what it was not told.
struct LoopLimits {
  double least_overlap = 0.3;
  double most_turned = 0.1;
  double most_contradiction = 0.08;
};

LoopEvidence weigh_loop(const ScanGroup& reference, const ScanGroup& query, const Pose2& T_reference_query);
bool is_possible(const LoopEvidence& evidence, const LoopLimits& limits = {});

/// Of the relative pose of two groups: what the walls tell of it that both have, as a wall across the way that one
/// of them alone has seen says nothing of the way; never better than what matching with a distance field of some
/// centimetres gives.
Matrix3 loop_information(const LoopEvidence& evidence);

}  // namespace gdtslam

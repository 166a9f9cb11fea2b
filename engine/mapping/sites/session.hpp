// A drive that was mapped, as it takes part in a merge: its keyframes and the graph of its path. Frame: the session's
// map. Plain data.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/loops/scan_group.hpp"
#include "engine/mapping/surface/surface_points.hpp"

namespace gdtslam {

/// Path length where another drive begins: far more than what belongs together.
inline constexpr double kBetweenDrives_m = 1000.0;

struct Session {
  std::vector<KeptScan> scans;      ///< scans of its keyframes
  std::vector<Pose2> poses;         ///< poses of its keyframes
  std::vector<double> path_m;       ///< travelled until each; kBetweenDrives_m more at each further drive
  std::vector<std::size_t> places;  ///< keyframes, ascending, the first one among them
  std::vector<PoseRelation> path;   ///< measured path between places, by their number
  std::vector<Loop> loops;          ///< loops between places, weighted by how far they are trusted
  std::vector<StepDoubt> doubts{};  ///< doubt of each keyframe; empty: they lie exactly at `poses`
};

/// Doubts stated by the path from place to place, in equal parts; none across a place that no relation reaches.
std::vector<StepDoubt> doubts_by_path(const Session& session);

}  // namespace gdtslam

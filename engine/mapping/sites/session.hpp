// A mapped drive as input of a merge: its keyframes and the graph of its path. Frame: the session's map. Plain data.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/loops/scan_group.hpp"
#include "engine/mapping/surface/surface_points.hpp"

namespace gdtslam {

/// Path length added where another drive begins: far longer than any stretch that belongs together.
inline constexpr double kBetweenDrives_m = 1000.0;

struct Session {
  std::vector<KeptScan> scans;      ///< scans of its keyframes
  std::vector<Pose2> poses;         ///< poses of its keyframes
  std::vector<double> path_m;       ///< path length up to each; kBetweenDrives_m more at each further drive
  std::vector<std::size_t> places;  ///< keyframes, ascending, the first one among them
  std::vector<PoseRelation> path;   ///< measured path between places, by their number
  std::vector<Loop> loops;          ///< loops between places, with their weights
  std::vector<StepDoubt> doubts{};  ///< doubt of each keyframe; empty: they lie exactly at `poses`
};

/// Doubts stated by the path from place to place, in equal parts; zero across a place that no relation reaches.
std::vector<StepDoubt> doubts_by_path(const Session& session);

}  // namespace gdtslam

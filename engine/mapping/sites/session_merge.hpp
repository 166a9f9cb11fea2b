// Merges sessions. Overlaps are found without start poses; each group of overlapping sessions becomes one robust graph
// with the loops between them, and all their keyframes are adjusted together. Sessions without overlap stay apart: a
// wrong edge is worse than none. Frame of a site: that of its first session. The same bits for any number of threads.
// Cost: some seconds for each session and site, plus closing the loops of one drive as long as all together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/adjust/joint_adjustment.hpp"
#include "engine/mapping/loops/loop_finder.hpp"
#include "engine/mapping/sites/session.hpp"
#include "engine/mapping/sites/site_growth.hpp"

namespace gdtslam {

struct MergeOptions {
  OverlapOptions overlap;
  LoopSearchOptions loops;
  int rounds = 2;  ///< over all places, of the search for loops
  JointOptions joint;
  BatchDevice device{};  ///< lays keyframes on each other
};

/// Sessions that lie in one frame.
struct MergedSite {
  std::vector<std::size_t> sessions;      ///< ascending
  std::vector<std::vector<Pose2>> poses;  ///< poses of each session's keyframes
  std::size_t loops_between = 0;          ///< active loops from one session to another
  std::size_t loops_off = 0;              ///< inactive loops from one session to another
  JointResult joint;
  PoseGraph graph;                   ///< keyframes count one session after the other
  std::vector<std::size_t> places;   ///< keyframe of each node
  std::vector<Matrix3> covariances;  ///< covariances of (x, y, theta) along the axes, one for each keyframe
  std::uint64_t searches = 0;        ///< number of searches for loops
};

struct MergedSessions {
  std::vector<SessionSearch> searches;  ///< each session in each site that existed then
  std::vector<SessionEdge> edges;       ///< between sessions of one site
  std::vector<MergedSite> sites;        ///< by their first session
};

MergedSessions merge_sessions(const std::vector<Session>& sessions, const MergeOptions& options, WorkerPool& workers,
                              const MergeProgress& progress);

}  // namespace gdtslam

// Grows sites: the session that saw most is the first, and each next one is searched in all sites so far, where alike
// parts of a building are more likely to show than in a single drive. At the end each edge is checked against the final
// sites. The same bits for any number of threads. Cost: a session against each site, not against each other session.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/sites/session.hpp"
#include "engine/mapping/sites/session_overlap.hpp"

namespace gdtslam {

/// The current step and its finished share.
using MergeProgress = std::function<void(std::string_view, double)>;

/// Two sessions of a site, and the poses of places of one in the map of the other.
struct SessionEdge {
  std::size_t reference = 0;
  std::size_t query = 0;
  std::vector<SessionFix> held;  ///< T_map_keyframe is in the reference's own map
};

/// Result of comparing a session with a site.
struct SessionSearch {
  std::size_t query = 0;
  std::vector<std::size_t> searched_in;  ///< the sessions of the site at that time, ascending
  SessionOverlap overlap;
  std::vector<SessionEdge> edges;  ///< to sessions of the site; empty if it was not joined, or was taken out again
  bool may_lie_elsewhere = false;  ///< it was joined, but as a whole it fits elsewhere too, so it was taken out
};

struct GrownSites {
  std::vector<SessionSearch> searches;           ///< in the order in which they were made
  std::vector<SessionEdge> edges;                ///< edges of all searches
  std::vector<std::vector<std::size_t>> groups;  ///< sessions that edges connect, ascending, ordered by their first
};

GrownSites grow_sites(const std::vector<Session>& sessions, const OverlapOptions& options, WorkerPool& workers,
                      const MergeProgress& progress);

}  // namespace gdtslam

// Sites that grow: the session that saw most is the first, and each next one is searched in the whole of what is there
// by then, where alike parts of a building are more likely to be seen than in any drive alone. What a session is joined
// by is held against the sites in the end once more. The same bits for any number of threads. Cost: a session against
// each site, not against each other session.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/sites/session.hpp"
#include "engine/mapping/sites/session_overlap.hpp"

namespace gdtslam {

/// The step at work, and the share of it that is done.
using MergeProgress = std::function<void(std::string_view, double)>;

/// Two sessions of a site, and where places of one lie in the map of the other.
struct SessionEdge {
  std::size_t reference = 0;
  std::size_t query = 0;
  std::vector<SessionFix> held;  ///< T_map_keyframe is in the reference's own map
};

/// Result of comparing a session with a site.
struct SessionSearch {
  std::size_t query = 0;
  std::vector<std::size_t> searched_in;  ///< the sessions of the site by then, ascending
  SessionOverlap overlap;
  std::vector<SessionEdge> edges;  ///< to sessions of the site; none where it was not joined, or did not stay so
  bool may_lie_elsewhere = false;  ///< it was joined, but as a whole it fits elsewhere too and was taken out for that
};

struct GrownSites {
  std::vector<SessionSearch> searches;           ///< in their order
  std::vector<SessionEdge> edges;                ///< edges of all searches
  std::vector<std::vector<std::size_t>> groups;  ///< sessions that edges connect, ascending, ordered by their first
};

GrownSites grow_sites(const std::vector<Session>& sessions, const OverlapOptions& options, WorkerPool& workers,
                      const MergeProgress& progress);

}  // namespace gdtslam

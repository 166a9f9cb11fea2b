// Spots of a site that look like another spot of it, by what the site itself saw. A wing that was driven often and its
// twin that was hardly seen do not look alike to a search: what belongs to the thin one fits better in the dense one,
// and there alone. But what was seen of the thin one fits in the dense one too, and that tells. Thread-safe once made.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/sessions/session_search.hpp"

namespace gdtslam {

class SiteRepeats {
 public:
  /// `site` and `map`, which is of it, must outlive this. Cost: a search for every other metre of the site's paths.
  SiteRepeats(const Session& site, const SessionMap& map, WorkerPool& workers);

  /// Whether the query, laid there, may lie at the other spot instead: some of what it saw is there too, and next to
  /// nothing that the site saw there speaks against it.
  [[nodiscard]] bool may_lie_elsewhere(const Session& query, const Pose2& T_site_query) const;

 private:
  struct Repeat {
    std::size_t keyframe = 0;  ///< of the site, where it saw one of the spots
    Pose2 T_site_there;        ///< where that fits as well
  };
  [[nodiscard]] std::vector<Pose2> other_ways(const Session& query, const Pose2& T_site_query) const;
  [[nodiscard]] bool is_way(const Session& query, const Pose2& T_site_query) const;

  const Session& site_;
  const SessionMap& map_;
  std::vector<Repeat> repeats_;
};

}  // namespace gdtslam

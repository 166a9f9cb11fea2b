// Spots of a site that look like another spot of it, by what the site itself saw. A wing that was driven often and its
// twin that was hardly seen do not look alike to a search: what belongs to the thin one fits better in the dense one,
// and there alone. But what was seen of the thin one fits in the dense one too, and that tells. Where several places
// tell the same, the building repeats itself, and it may do so beyond what was seen of it. Thread-safe once made.
#pragma once

#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/sessions/session_search.hpp"

namespace gdtslam {

class SiteRepeats {
 public:
  /// `map` is of the site and must outlive this. Cost: a search for every other metre of the site's paths.
  SiteRepeats(const Session& site, const SessionMap& map, WorkerPool& workers);

  /// Whether the query, laid there, may lie at the other spot instead: some of what it saw is there too, and next to
  /// nothing that the site saw there speaks against it; or, where the building repeats itself, nothing that was seen
  /// speaks against it.
  [[nodiscard]] bool may_lie_elsewhere(const Session& query, const Pose2& T_site_query) const;

 private:
  struct Repeat {
    Pose2 T_site_spot;
    Pose2 T_site_twin;       ///< pose at which the site looks the same
    bool is_shared = false;  ///< by places enough to tell that the building repeats itself
  };
  struct Way {
    Pose2 T_site_query;
    bool is_shared = false;
  };
  void tell_shared_ones();
  [[nodiscard]] std::vector<Way> other_ways(const Session& query, const Pose2& T_site_query) const;
  [[nodiscard]] bool is_possible(const Session& query, const Way& way) const;

  const SessionMap& map_;
  std::vector<Repeat> repeats_;
};

}  // namespace gdtslam

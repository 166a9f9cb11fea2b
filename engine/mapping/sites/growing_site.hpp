// A site while it grows: sessions in one frame, in which others are searched, and what was found out about sites that
// were there before, so that nothing is searched for twice. Frame: that of the first session. One thread at a time.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/sites/session.hpp"
#include "engine/mapping/sites/session_overlap.hpp"
#include "engine/mapping/sites/session_search.hpp"
#include "engine/mapping/sites/site_growth.hpp"

namespace gdtslam {

/// Spots of a site that look like another spot of it, by what the site itself saw. A wing that was driven often and its
/// twin that was hardly seen do not look alike to a search: what belongs to the thin one fits better in the dense one,
/// and there alone. But what was seen of the thin one fits in the dense one too, and that tells. Where several places
/// tell the same, the building repeats itself, and it may do so beyond what was seen of it. Thread-safe once made.
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

/// Edges of the second are joined with those of the first that connect the same sessions.
void add_edges(std::vector<SessionEdge>& edges, const std::vector<SessionEdge>& more);

class GrowingSite {
 public:
  /// All that is given by reference must outlive it. `group` is ascending.
  GrowingSite(std::vector<std::size_t> group, const std::vector<Session>& sessions, std::vector<SessionEdge> edges,
              const SessionSearchOptions& options);

  [[nodiscard]] const std::vector<std::size_t>& group() const { return group_; }
  [[nodiscard]] bool holds(std::size_t session) const;
  [[nodiscard]] const std::vector<SessionEdge>& edges() const { return edges_; }

  /// Made when it is asked for first, as the next two are.
  const SessionMap& map();
  const Session& whole();
  const SiteRepeats& repeats(WorkerPool& workers);
  Pose2 T_site_keyframe(std::size_t session, std::size_t keyframe);
  /// Edge from the place of a single session at which the query lies.
  SessionEdge make_edge(std::size_t query, SessionFix fix);

 private:
  std::vector<std::size_t> group_;
  const std::vector<Session>& sessions_;
  std::vector<SessionEdge> edges_;
  const SessionSearchOptions& options_;
  std::unique_ptr<Session> whole_;
  std::unique_ptr<SessionMap> map_;
  std::unique_ptr<SiteRepeats> repeats_;
};

/// find_overlap() of each session in each site that there was, kept: sites that grow anew begin as they did before.
/// Memory: some kilobytes a pair.
class KnownOverlaps {
 public:
  /// Before refuse_doubtful().
  const SessionOverlap& of(GrowingSite& site, const Session& query, std::size_t number, const OverlapOptions& options,
                           WorkerPool& workers);

 private:
  // The query, the sessions of the site and all that its edges say: what an overlap depends on.
  using Key = std::tuple<std::size_t, std::vector<std::size_t>, std::vector<double>>;
  std::map<Key, SessionOverlap> known_;
};

}  // namespace gdtslam

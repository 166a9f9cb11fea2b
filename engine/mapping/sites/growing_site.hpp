// A site while it grows: sessions in one frame, in which others are searched, and search results of earlier sites, so
// that nothing is searched twice. Frame: that of the first session. One thread at a time.
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

/// Spots of a site that look like another spot of the same site. A wing that was driven often and its twin that was
/// hardly seen do not look alike to a search: a part of the sparse twin fits better in the dense one. But the view of
/// the sparse twin fits in the dense one too, which reveals the pair. If several places show the same repeat, the
/// building repeats itself, perhaps beyond the part that was seen. Thread-safe once made.
class SiteRepeats {
 public:
  /// `map` is of the site and must outlive this. Cost: a search for every other metre of the site's paths.
  SiteRepeats(const Session& site, const SessionMap& map, WorkerPool& workers);

  /// True if the query, laid at this pose, may lie at another spot instead. Some of its walls must be there too, with
  /// almost no contradiction by the site. If the building repeats itself, it is enough that nothing contradicts.
  [[nodiscard]] bool may_lie_elsewhere(const Session& query, const Pose2& T_site_query) const;

 private:
  struct Repeat {
    Pose2 T_site_spot;
    Pose2 T_site_twin;       ///< pose at which the site looks the same
    bool is_shared = false;  ///< enough places show it: the building repeats itself
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

/// Adds the edges of the second list to the first; edges between the same sessions are merged.
void add_edges(std::vector<SessionEdge>& edges, const std::vector<SessionEdge>& more);

class GrowingSite {
 public:
  /// All references must outlive this. `group` is ascending.
  GrowingSite(std::vector<std::size_t> group, const std::vector<Session>& sessions, std::vector<SessionEdge> edges,
              const SessionSearchOptions& options);

  [[nodiscard]] const std::vector<std::size_t>& group() const { return group_; }
  [[nodiscard]] bool holds(std::size_t session) const;
  [[nodiscard]] const std::vector<SessionEdge>& edges() const { return edges_; }

  /// Computed at the first call, as the next two are.
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

/// Keeps the results of find_overlap() for each session and site: sites that grow again start the same way. Memory:
/// some kilobytes a pair.
class KnownOverlaps {
 public:
  /// The overlap before refuse_doubtful().
  const SessionOverlap& of(GrowingSite& site, const Session& query, std::size_t number, const OverlapOptions& options,
                           WorkerPool& workers);

 private:
  // The query, the sessions of the site and its edges: the inputs of an overlap.
  using Key = std::tuple<std::size_t, std::vector<std::size_t>, std::vector<double>>;
  std::map<Key, SessionOverlap> known_;
};

}  // namespace gdtslam

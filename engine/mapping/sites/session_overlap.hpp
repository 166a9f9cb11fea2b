// Decides whether and where a session lies in an existing site: its places are searched in the whole site, and the
// result is weighed against every other pose of the session. Cost: some tenths of a second for each place of the
// session.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/sites/session.hpp"
#include "engine/mapping/sites/session_search.hpp"

namespace gdtslam {

struct OverlapOptions {
  SessionSearchOptions search;
  AgreementLimits agreement;
  double least_alone = 0.8;     ///< share of the places found that fit nowhere else: else the building repeats itself
  double alone_at_last = 0.5;   ///< the same for the sessions left after all surer ones have joined
  double alone_of_any = 0.5;    ///< with a smaller share a session fits everywhere
  double least_fitting = 0.6;   ///< share of the places, put by the overlap where both drove, that fit
  std::size_t least_rival = 2;  ///< least number of places that another pose of the session must explain to count
};

struct SessionOverlap {
  std::vector<SessionFix> fixes;  ///< fixes of all places that were searched, and of keyframes next to them
  std::size_t possible = 0;       ///< fixes found with nothing against them
  std::size_t alone = 0;          ///< possible fixes that fit nowhere else as well
  std::size_t explained = 0;      ///< fixes that fit the chosen pose of the session
  std::size_t rival = 0;          ///< uncontradicted fixes that fit another pose of the session
  std::size_t met = 0;            ///< places of the session, at this pose, at which a drive of the site was too
  std::size_t fitting = 0;        ///< met places that fit there
  std::vector<SessionFix> held;   ///< fixes that agree; empty if the session does not belong to the site
  bool is_undecided = false;      ///< some agree, and too much speaks against it

  /// True if a place was found in the site at the place of this keyframe.
  [[nodiscard]] bool finds(const Session& query, std::size_t keyframe) const;
  /// True if that place was found in several spots of the site.
  [[nodiscard]] bool repeats(const Session& query, std::size_t keyframe) const;
};

/// Collects the evidence for and against the session lying in the site of `map`. It does not depend on
/// `options.least_alone`. The same bits for any number of threads.
SessionOverlap find_overlap(const SessionMap& map, const Session& query, const OverlapOptions& options,
                            WorkerPool& workers);

/// The verdict: if there is too much evidence against the overlap, removes all its fixes.
void refuse_doubtful(const OverlapOptions& options, SessionOverlap& overlap);

/// The rule by which a session was not joined, after the verdict; rules have the numbers of docs/howto/merge.md.
std::string rule_that_failed(const OverlapOptions& options, const SessionOverlap& overlap);

}  // namespace gdtslam

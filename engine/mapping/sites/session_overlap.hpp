// Whether and where a session lies in a site that is there already: its places are searched in the whole of the site,
// and what was found is weighed against every other way to lay the session on it. Cost: some tenths of a second for
// each place of the session.
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
  double alone_at_last = 0.5;   ///< and of sessions that are left when all that are surer are in
  double alone_of_any = 0.5;    ///< with a smaller share a session fits everywhere
  double least_fitting = 0.6;   ///< share of the places that the overlap puts where both drove
  std::size_t least_rival = 2;  ///< places that another way to lay the session has to explain to count as one
};

struct SessionOverlap {
  std::vector<SessionFix> fixes;  ///< fixes of all places that were looked for, and of keyframes next to them
  std::size_t possible = 0;       ///< fixes found with nothing against them
  std::size_t alone = 0;          ///< possible fixes that fit nowhere else as well
  std::size_t explained = 0;      ///< fixes found that fit the way in which the session is laid
  std::size_t rival = 0;          ///< and where another way to lay it has them that nothing speaks against
  std::size_t met = 0;            ///< places at which a drive of the site was too, laid like this
  std::size_t fitting = 0;        ///< met places that fit there
  std::vector<SessionFix> held;   ///< fixes that agree; empty if the session does not belong there
  bool is_undecided = false;      ///< some agree, and too much speaks against it

  /// Whether the keyframe is beside one that was found in the site.
  [[nodiscard]] bool finds(const Session& query, std::size_t keyframe) const;
  /// And in several spots of it.
  [[nodiscard]] bool repeats(const Session& query, std::size_t keyframe) const;
};

/// Collects the evidence for and against the session lying in the site that `map` is of. It does not depend on
/// `options.least_alone`. The same bits for any number of threads.
SessionOverlap find_overlap(const SessionMap& map, const Session& query, const OverlapOptions& options,
                            WorkerPool& workers);

/// The verdict: where what speaks against it is too much, nothing holds the session there.
void refuse_doubtful(const OverlapOptions& options, SessionOverlap& overlap);

/// Why a session was not joined, after the verdict; rules have the numbers of docs/howto/merge.md.
std::string rule_that_failed(const OverlapOptions& options, const SessionOverlap& overlap);

}  // namespace gdtslam

// Sessions joined: which of them overlap is found without start poses, each group of those that do becomes one robust
// graph with the loops between them, and all their keyframes are adjusted together. What does not overlap stays apart:
// a wrong edge is worse than none. Frame of a site: that of its first session. The same bits for any number of threads.
// Cost: some seconds for each pair of sessions, and as much as closing the loops of one drive as long as all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/adjust/joint_adjustment.hpp"
#include "engine/mapping/loops/loop_finder.hpp"
#include "engine/mapping/sessions/session.hpp"
#include "engine/mapping/sessions/session_search.hpp"

namespace gdtslam {

/// Two sessions that overlap, or do not.
struct SessionJoint {
  std::size_t reference = 0;          ///< the one that was searched in
  std::size_t query = 0;              ///< whose places were looked for
  std::size_t searched = 0;           ///< places and keyframes beside them
  std::size_t possible = 0;           ///< of these, found with nothing against it
  std::size_t alone = 0;              ///< of these, that fit nowhere else as well
  std::size_t explained = 0;          ///< of those found, that fit where the two are joined
  std::size_t rival = 0;              ///< and where the second best way to join them has them
  std::size_t met = 0;                ///< of all places, that the joint puts where the reference drove too
  std::size_t fitting = 0;            ///< of these, that fit there
  std::vector<std::size_t> repeated;  ///< keyframes of the query that were found, and fit elsewhere as well
  std::vector<SessionFix> held;       ///< fixes that agree; empty where the two are not joined
};

struct MergeOptions {
  SessionSearchOptions search;
  AgreementLimits agreement;
  std::size_t enough = 6;      ///< fixes that agree, after which no more are looked for
  double least_alone = 0.5;    ///< share of the places found that fit nowhere else: else the building repeats itself
  double least_fitting = 0.6;  ///< share of the places that the joint puts where both drove
  double most_rival = 0.5;     ///< share of what a joint explains that another way to join the two may explain
  LoopSearchOptions loops;
  int rounds = 2;  ///< over all places, of the search for loops
  JointOptions joint;
};

/// Sessions that lie in one frame.
struct MergedSite {
  std::vector<std::size_t> sessions;      ///< ascending
  std::vector<std::vector<Pose2>> poses;  ///< of the keyframes of each
  std::size_t loops_between = 0;          ///< loops from one session to another that hold
  std::size_t loops_off = 0;              ///< and that do not
  JointResult joint;
  PoseGraph graph;                   ///< keyframes count one session after the other
  std::vector<std::size_t> places;   ///< which of all keyframes its nodes are
  std::vector<Matrix3> covariances;  ///< of all keyframes, of (x, y, theta) along the axes
  std::uint64_t searches = 0;        ///< for loops
};

struct MergedSessions {
  std::vector<SessionJoint> joints;  ///< every pair, by their numbers
  std::vector<MergedSite> sites;     ///< by their first session
};

/// The step at work, and the share of it that is done.
using MergeProgress = std::function<void(std::string_view, double)>;

MergedSessions merge_sessions(const std::vector<Session>& sessions, const MergeOptions& options, WorkerPool& workers,
                              const MergeProgress& progress);

}  // namespace gdtslam

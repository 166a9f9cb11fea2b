#include "session_merge.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "engine/mapping/sessions/site_graph.hpp"

namespace gdtslam {
namespace {

constexpr double kSameWay_m = 1.0;  // of two ways to lay a session on another
constexpr double kSameWay_rad = 0.35;
constexpr double kSamePlace_m = 1.0;  // of path
constexpr std::size_t kMostWays = 40;
constexpr std::size_t kSearchesAtOnce = 8;  // before it is asked whether enough were found

// The larger one is searched in: more of the other's places are there.
SessionJoint joint_of(std::size_t a, std::size_t b, const std::vector<Session>& sessions) {
  const bool is_b_larger = sessions[b].places.size() > sessions[a].places.size();
  SessionJoint joint;
  joint.reference = is_b_larger ? b : a;
  joint.query = is_b_larger ? a : b;
  return joint;
}

// Some at a time, until enough agree.
void look_for(const std::vector<std::size_t>& keyframes, const SessionMap& map, const Session& query,
              const MergeOptions& options, WorkerPool& workers, std::vector<SessionFix>& fixes) {
  for (std::size_t first = 0; first < keyframes.size(); first += kSearchesAtOnce) {
    const std::size_t before = fixes.size();
    fixes.resize(before + std::min(kSearchesAtOnce, keyframes.size() - first));
    workers.run(fixes.size() - before, 1, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t k = begin; k < end; ++k) fixes[before + k] = map.find(query, keyframes[first + k]);
    });
    if (agreeing(query, fixes, options.agreement).size() >= options.enough) break;
  }
}

// Places all along the path; where too few of them agree, what lies beside those that were found.
std::vector<SessionFix> find_places(const SessionMap& map, const Session& query, const MergeOptions& options,
                                    WorkerPool& workers) {
  std::vector<SessionFix> fixes;
  look_for(places_to_look_for(query, options.search.most_places), map, query, options, workers, fixes);
  if (!agreeing(query, fixes, options.agreement).empty()) return fixes;
  std::vector<std::size_t> beside;
  for (const SessionFix& fix : fixes) {
    if (!fix.is_alone) continue;
    for (const std::size_t keyframe : keyframes_beside(query, fix.keyframe)) beside.push_back(keyframe);
  }
  if (beside.size() > options.search.most_beside) beside.resize(options.search.most_beside);
  look_for(beside, map, query, options, workers, fixes);
  return fixes;
}

// How many of the places that were found fit where this pose of the query's map has them.
std::size_t explained_by(const Pose2& T_map_query, const SessionMap& map, const Session& query,
                         const std::vector<SessionFix>& found, WorkerPool& workers) {
  std::vector<char> fits(found.size());
  workers.run(found.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t k = begin; k < end; ++k) {
      fits[k] = map.fits(query, found[k], T_map_query * query.poses[found[k].keyframe]) ? 1 : 0;
    }
  });
  return static_cast<std::size_t>(std::count(fits.begin(), fits.end(), 1));
}

// By the fix in the middle of those that agree.
Pose2 T_map_query_of(const SessionJoint& joint, const Session& query) {
  const SessionFix& middle = joint.held[joint.held.size() / 2];
  return middle.T_map_keyframe * inverse(query.poses[middle.keyframe]);
}

// That pose first, then the ways to lay the query that any place found speaks for, those beside one that is there
// already left out.
std::vector<Pose2> ways_to_join(const Session& query, const std::vector<SessionFix>& found, const Pose2& T_map_query) {
  const ExcludedPoses same{{}, kSameWay_m, kSameWay_rad};
  std::vector<Pose2> ways{T_map_query};
  const auto take = [&](const SessionFix& fix, const Pose2& T_map_keyframe) {
    const Pose2& at = query.poses[fix.keyframe];
    const bool is_known = std::any_of(ways.begin(), ways.end(),
                                      [&](const Pose2& way) { return same.hold(between(way * at, T_map_keyframe)); });
    if (!is_known && ways.size() < kMostWays) ways.push_back(T_map_keyframe * inverse(at));
  };
  for (const SessionFix& fix : found) {
    take(fix, fix.T_map_keyframe);
    if (fix.T_map_elsewhere) take(fix, *fix.T_map_elsewhere);
  }
  return ways;
}

// A building that repeats itself can be laid on itself in several ways, each of which fits in places that the other
// session happens to have seen once: what is right explains far more than any other way.
void weigh_rivals(const SessionMap& map, const Session& query, const std::vector<SessionFix>& fixes,
                  WorkerPool& workers, SessionJoint& joint) {
  std::vector<SessionFix> found;
  std::copy_if(fixes.begin(), fixes.end(), std::back_inserter(found), [](const auto& fix) { return fix.is_possible; });
  const std::vector<Pose2> ways = ways_to_join(query, found, T_map_query_of(joint, query));
  joint.explained = explained_by(ways.front(), map, query, found, workers);
  for (std::size_t k = 1; k < ways.size(); ++k) {
    joint.rival = std::max(joint.rival, explained_by(ways[k], map, query, found, workers));
  }
}

// Where both drove both saw the same: of a wrong joint a corner or two fit, and what lies between does not.
void test_joint(const SessionMap& map, const Session& query, WorkerPool& workers, SessionJoint& joint) {
  const Pose2 T_map_query = T_map_query_of(joint, query);
  std::vector<SessionMap::Test> tests(query.places.size());
  workers.run(tests.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t k = begin; k < end; ++k) {
      const std::size_t keyframe = query.places[k];
      tests[k] = map.test(query, keyframe, T_map_query * query.poses[keyframe]);
    }
  });
  const auto count = [&tests](SessionMap::Test what) {
    return static_cast<std::size_t>(std::count(tests.begin(), tests.end(), what));
  };
  joint.fitting = count(SessionMap::Test::kFits);
  joint.met = joint.fitting + count(SessionMap::Test::kDoesNotFit);
}

void find_overlap(const SessionMap& map, const Session& query, const MergeOptions& options, WorkerPool& workers,
                  SessionJoint& joint) {
  const std::vector<SessionFix> fixes = find_places(map, query, options, workers);
  joint.searched = fixes.size();
  const auto count = [&fixes](bool SessionFix::*is) {
    return static_cast<std::size_t>(
        std::count_if(fixes.begin(), fixes.end(), [is](const auto& fix) { return fix.*is; }));
  };
  joint.possible = count(&SessionFix::is_possible);
  joint.alone = count(&SessionFix::is_alone);
  for (const SessionFix& fix : fixes) {
    if (fix.is_possible && !fix.is_alone) joint.repeated.push_back(fix.keyframe);
  }
  for (const std::size_t k : agreeing(query, fixes, options.agreement)) joint.held.push_back(fixes[k]);
  if (joint.held.empty()) return;
  weigh_rivals(map, query, fixes, workers, joint);
  test_joint(map, query, workers, joint);
  const auto share = [](std::size_t part, std::size_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
  };
  if (share(joint.alone, joint.possible) < options.least_alone ||
      share(joint.rival, joint.explained) > options.most_rival ||
      static_cast<double>(joint.fitting) < options.least_fitting * static_cast<double>(joint.met)) {
    joint.held.clear();
  }
}

/// What all pairs together tell of places that are there more than once.
class RepeatedPlaces {
 public:
  RepeatedPlaces(const std::vector<Session>& sessions, const std::vector<SessionJoint>& joints)
      : sessions_(sessions), of_session_(sessions.size()) {
    for (const SessionJoint& joint : joints) {
      std::vector<std::size_t>& all = of_session_[joint.query];
      all.insert(all.end(), joint.repeated.begin(), joint.repeated.end());
    }
  }
  /// Whether the keyframe is beside one that fits in several spots of any session.
  [[nodiscard]] bool hold(std::size_t session, std::size_t keyframe) const {
    const std::vector<double>& path_m = sessions_[session].path_m;
    return std::any_of(of_session_[session].begin(), of_session_[session].end(), [&](std::size_t repeated) {
      return std::fabs(path_m[repeated] - path_m[keyframe]) <= kSamePlace_m;
    });
  }

 private:
  const std::vector<Session>& sessions_;
  std::vector<std::vector<std::size_t>> of_session_;
};

// Two drives that saw one of two wings each fit on each other without a flaw; a third that saw both tells.
void drop_repeated(const std::vector<Session>& sessions, const AgreementLimits& limits,
                   std::vector<SessionJoint>& joints) {
  const RepeatedPlaces repeated(sessions, joints);
  for (SessionJoint& joint : joints) {
    std::erase_if(joint.held, [&](const SessionFix& fix) {
      return repeated.hold(joint.query, fix.keyframe) ||
             repeated.hold(joint.reference, sessions[joint.reference].places[fix.reference_place]);
    });
    if (joint.held.size() < limits.least) joint.held.clear();
  }
}

// One map at a time is prepared.
std::vector<SessionJoint> find_joints(const std::vector<Session>& sessions, const MergeOptions& options,
                                      WorkerPool& workers, const MergeProgress& progress) {
  std::vector<SessionJoint> joints;
  for (std::size_t b = 1; b < sessions.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) joints.push_back(joint_of(a, b, sessions));
  }
  std::size_t done = 0;
  for (std::size_t reference = 0; reference < sessions.size(); ++reference) {
    std::unique_ptr<SessionMap> map;
    for (SessionJoint& joint : joints) {
      if (joint.reference != reference) continue;
      if (!map) map = std::make_unique<SessionMap>(sessions[reference], options.search);
      find_overlap(*map, sessions[joint.query], options, workers, joint);
      progress("looking where sessions overlap", static_cast<double>(++done) / static_cast<double>(joints.size()));
    }
  }
  drop_repeated(sessions, options.agreement, joints);
  return joints;
}

// Each session with all that it can be reached from, by their first.
std::vector<std::vector<std::size_t>> groups_of(std::size_t sessions, const std::vector<SessionJoint>& joints) {
  std::vector<std::size_t> first(sessions);
  for (std::size_t i = 0; i < sessions; ++i) first[i] = i;
  for (const SessionJoint& joint : joints) {
    if (joint.held.empty()) continue;
    const std::size_t from = std::max(first[joint.reference], first[joint.query]);
    const std::size_t to = std::min(first[joint.reference], first[joint.query]);
    std::replace(first.begin(), first.end(), from, to);
  }
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < sessions; ++i) {
    if (first[i] == i) groups.emplace_back();
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& g) { return (g.empty() ? i : g.front()) == first[i]; });
    group->push_back(i);
  }
  return groups;
}

MergedSite merge_group(const std::vector<std::size_t>& group, const std::vector<Session>& sessions,
                       const std::vector<SessionJoint>& joints, const MergeOptions& options, WorkerPool& workers,
                       const MergeProgress& progress) {
  MergedSite site;
  site.sessions = group;
  SiteGraph graph(group, sessions, joints);
  if (group.size() > 1) {
    LoopFinder finder(options.loops);
    graph.show_to(finder);
    for (int round = 0; round < options.rounds; ++round) {
      graph.close_loops(finder, workers, [&](double share) {
        progress("closing loops between sessions", (share + round) / options.rounds);
      });
    }
    site.searches = finder.counts().searched;
    site.loops_between = graph.loops_between(true);
    site.loops_off = graph.loops_between(false);
    site.joint = JointAdjustment(graph.scans(), graph.held_relations(), options.joint)
                     .run(graph.poses(), workers, [&](double share) { progress("adjusting keyframes", share); });
    graph.return_to_frame();
  }
  site.poses = graph.poses_of_sessions();
  site.graph = graph.graph();
  site.places = graph.places();
  site.covariances = graph.covariances();
  return site;
}

}  // namespace

MergedSessions merge_sessions(const std::vector<Session>& sessions, const MergeOptions& options, WorkerPool& workers,
                              const MergeProgress& progress) {
  MergedSessions merged{.joints = find_joints(sessions, options, workers, progress), .sites = {}};
  for (const std::vector<std::size_t>& group : groups_of(sessions.size(), merged.joints)) {
    merged.sites.push_back(merge_group(group, sessions, merged.joints, options, workers, progress));
  }
  return merged;
}

}  // namespace gdtslam

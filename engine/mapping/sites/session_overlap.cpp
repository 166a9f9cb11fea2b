#include "session_overlap.hpp"

#include <algorithm>
#include <iterator>

namespace gdtslam {
namespace {

constexpr double kSameWay_m = 1.0;  // distance up to which two ways to lay a session on a site are the same
constexpr double kSameWay_rad = 0.35;
constexpr std::size_t kMostWays = 40;

std::vector<SessionFix> look_for(const std::vector<std::size_t>& keyframes, const SessionMap& map, const Session& query,
                                 WorkerPool& workers) {
  std::vector<SessionFix> fixes(keyframes.size());
  workers.run(fixes.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t k = begin; k < end; ++k) fixes[k] = map.find(query, keyframes[k]);
  });
  return fixes;
}

// Searches places all along the path, none left out: evidence for another pose of the session must show. If too few
// agree, keyframes next to the places found are searched too.
std::vector<SessionFix> find_places(const SessionMap& map, const Session& query, const OverlapOptions& options,
                                    WorkerPool& workers) {
  std::vector<SessionFix> fixes = look_for(places_to_look_for(query, options.search.most_places), map, query, workers);
  if (!agreeing(query, fixes, options.agreement).empty()) return fixes;
  std::vector<std::size_t> beside;
  for (const SessionFix& fix : fixes) {
    if (!fix.is_alone) continue;
    for (const std::size_t keyframe : keyframes_beside(query, fix.keyframe)) beside.push_back(keyframe);
  }
  if (beside.size() > options.search.most_beside) beside.resize(options.search.most_beside);
  const std::vector<SessionFix> more = look_for(beside, map, query, workers);
  fixes.insert(fixes.end(), more.begin(), more.end());
  return fixes;
}

// Counts the found places that fit at this pose of the query's map.
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

// Pose by the fix in the middle of those that agree.
Pose2 T_map_query_of(const SessionOverlap& overlap, const Session& query) {
  const SessionFix& middle = overlap.held[overlap.held.size() / 2];
  return middle.T_map_keyframe * inverse(query.poses[middle.keyframe]);
}

// That pose first, then the poses of the query that other places found support, without those near one that is already
// in the list.
std::vector<Pose2> ways_to_lay(const Session& query, const std::vector<SessionFix>& found, const Pose2& T_map_query) {
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

// Places where both drove and saw the same. If the session is laid wrongly, a corner or two fit and the places between
// do not.
struct Met {
  std::size_t places = 0;
  std::size_t fitting = 0;
  [[nodiscard]] bool fit(double least) const {
    return static_cast<double>(fitting) >= least * static_cast<double>(places);
  }
};

Met places_met(const SessionMap& map, const Session& query, const Pose2& T_map_query, WorkerPool& workers) {
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
  const std::size_t fitting = count(SessionMap::Test::kFits);
  return {fitting + count(SessionMap::Test::kDoesNotFit), fitting};
}

// A building that repeats itself can be laid on itself in several ways, each of which fits in some places. Evidence
// against a way shows that it is wrong, not the amount of evidence for it: a way counts for nothing if the robot would
// have driven through walls, or if both drove there and saw something else.
void weigh_rivals(const SessionMap& map, const Session& query, const OverlapOptions& options, WorkerPool& workers,
                  SessionOverlap& overlap) {
  std::vector<SessionFix> found;
  std::copy_if(overlap.fixes.begin(), overlap.fixes.end(), std::back_inserter(found),
               [](const auto& fix) { return fix.is_possible; });
  const std::vector<Pose2> ways = ways_to_lay(query, found, T_map_query_of(overlap, query));
  overlap.explained = explained_by(ways.front(), map, query, found, workers);
  for (std::size_t k = 1; k < ways.size(); ++k) {
    const std::size_t explained = explained_by(ways[k], map, query, found, workers);
    if (explained < options.least_rival || explained <= overlap.rival || map.has_walls_in_the_way(query, ways[k]) ||
        !places_met(map, query, ways[k], workers).fit(options.least_fitting)) {
      continue;
    }
    overlap.rival = explained;
  }
}

}  // namespace

bool SessionOverlap::finds(const Session& query, std::size_t keyframe) const {
  return std::any_of(fixes.begin(), fixes.end(), [&](const SessionFix& fix) {
    return fix.is_possible && are_at_one_place(query, fix.keyframe, keyframe);
  });
}

bool SessionOverlap::repeats(const Session& query, std::size_t keyframe) const {
  return std::any_of(fixes.begin(), fixes.end(), [&](const SessionFix& fix) {
    return fix.is_possible && !fix.is_alone && are_at_one_place(query, fix.keyframe, keyframe);
  });
}

SessionOverlap find_overlap(const SessionMap& map, const Session& query, const OverlapOptions& options,
                            WorkerPool& workers) {
  SessionOverlap overlap;
  overlap.fixes = find_places(map, query, options, workers);
  const auto count = [&overlap](bool SessionFix::*is) {
    return static_cast<std::size_t>(
        std::count_if(overlap.fixes.begin(), overlap.fixes.end(), [is](const auto& fix) { return fix.*is; }));
  };
  overlap.possible = count(&SessionFix::is_possible);
  overlap.alone = count(&SessionFix::is_alone);
  for (const std::size_t k : agreeing(query, overlap.fixes, options.agreement)) {
    if (!overlap.repeats(query, overlap.fixes[k].keyframe)) overlap.held.push_back(overlap.fixes[k]);
  }
  if (overlap.held.size() < options.agreement.least) overlap.held.clear();
  if (overlap.held.empty()) return overlap;
  weigh_rivals(map, query, options, workers, overlap);
  const Met met = places_met(map, query, T_map_query_of(overlap, query), workers);
  overlap.met = met.places;
  overlap.fitting = met.fitting;
  return overlap;
}

void refuse_doubtful(const OverlapOptions& options, SessionOverlap& overlap) {
  if (overlap.held.empty()) return;
  const Met met{overlap.met, overlap.fitting};
  if (static_cast<double>(overlap.alone) >= options.least_alone * static_cast<double>(overlap.possible) &&
      overlap.rival == 0 && met.fit(options.least_fitting)) {
    return;
  }
  overlap.held.clear();
  overlap.is_undecided = true;
}

std::string rule_that_failed(const OverlapOptions& options, const SessionOverlap& overlap) {
  if (overlap.explained == 0) return "fewer than three of them fit nowhere else and agree (rules 2 and 3)";
  if (!overlap.is_undecided) {
    return "three or more agree, and what other sites or later runs show is against it (rules 4 to 8)";
  }
  if (overlap.rival > 0) {
    return std::to_string(overlap.rival) + " of them fit in another way to lay it, too (rule 4)";
  }
  if (!Met{overlap.met, overlap.fitting}.fit(options.least_fitting)) {
    return "of " + std::to_string(overlap.met) + " places where both would have driven only " +
           std::to_string(overlap.fitting) + " fit (rule 5)";
  }
  return "too many of them fit elsewhere as well (rule 4)";
}

}  // namespace gdtslam

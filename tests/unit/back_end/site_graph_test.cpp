// Sessions laid beside each other by hand: where each comes to lie, what the graph then holds, and a site as it grows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/sites/growing_site.hpp"
#include "engine/mapping/sites/session_merge.hpp"
#include "engine/mapping/sites/site_graph.hpp"
#include "gdtslam/core/angle.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

constexpr double kQuarter = 0.5 * kPi;
const Matrix3 kSure = Matrix3::diagonal(1.0e8, 1.0e8, 1.0e8);

/// Straight on from `first`, a metre from keyframe to keyframe, each second one a place.
Session straight_on(std::size_t keyframes, const Pose2& first = {}) {
  Session session;
  for (std::size_t i = 0; i < keyframes; ++i) {
    session.scans.emplace_back();
    session.poses.push_back(first * Pose2{static_cast<double>(i), 0.0, 0.0});
    session.path_m.push_back(static_cast<double>(i));
    if (i % 2 == 0) session.places.push_back(i);
  }
  for (std::size_t k = 1; k < session.places.size(); ++k) {
    session.path.push_back({k - 1, k, Pose2{2.0, 0.0, 0.0}, kSure});
  }
  return session;
}

SessionFix fix_at(std::size_t keyframe, std::size_t reference_place, const Pose2& T_map_keyframe, double overlap) {
  SessionFix fix;
  fix.keyframe = keyframe;
  fix.reference_place = reference_place;
  fix.T_map_keyframe = T_map_keyframe;
  fix.evidence = {.overlap = overlap, .shape = Matrix3::diagonal(0.2, 0.6, 0.3)};
  fix.is_possible = fix.is_alone = true;
  return fix;
}

// The second session stands across the first: its keyframe k lies at (2, 3 + k).
TEST(SiteGraph, ASessionLiesWhereItsBestFixHasIt) {
  const std::vector<Session> sessions{straight_on(4), straight_on(4)};
  const Pose2 wrong{2.5, 5.0, kQuarter};
  const SiteGraph graph({0, 1}, sessions,
                        {{0, 1, {fix_at(2, 1, wrong, 0.5), fix_at(3, 1, {2.0, 6.0, kQuarter}, 0.6)}}});
  const std::vector<std::vector<Pose2>> poses = graph.poses_of_sessions();
  ASSERT_EQ(poses.size(), 2U);
  ASSERT_EQ(poses[0].size(), 4U);
  ASSERT_EQ(poses[1].size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto away = static_cast<double>(k);
    EXPECT_THAT(poses[0][k], PoseNear({away, 0.0, 0.0}, 0.001, 0.01)) << k;
    EXPECT_THAT(poses[1][k], PoseNear({2.0, 3.0 + away, kQuarter}, 0.001, 0.01)) << k;
  }
  EXPECT_EQ(graph.places(), (std::vector<std::size_t>{0, 2, 4, 6}));
  ASSERT_EQ(graph.graph().path.size(), 3U) << "one a session, and the best fix";
  // The keyframe behind the place is seen from the place before it.
  EXPECT_EQ(graph.graph().path[1].from, 2U);
  EXPECT_EQ(graph.graph().path[1].to, 3U);
  EXPECT_EQ(graph.graph().path[2].from, 1U);
  EXPECT_EQ(graph.graph().path[2].to, 3U);
  EXPECT_THAT(graph.graph().path[2].T_from_to, PoseNear({0.0, 5.0, kQuarter}, 1e-9, 1e-7));
  EXPECT_EQ(graph.loops_between(true), 1U) << "the best one is a loop, too";
  EXPECT_EQ(graph.loops_between(false), 1U) << "half a metre off";
}

// Found the other way round, in the map of a session that comes later: keyframe k of that one lies at (-2, 1 - k).
TEST(SiteGraph, AFixInALaterSessionIsTurnedRound) {
  const std::vector<Session> sessions{straight_on(4), straight_on(4)};
  const Pose2 T_second_first{1.0, 2.0, kQuarter};
  const SessionFix fix = fix_at(0, 1, T_second_first, 0.5);
  const SiteGraph graph({0, 1}, sessions, {{1, 0, {fix}}});
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_THAT(graph.poses_of_sessions()[1][k], PoseNear({-2.0, 1.0 - static_cast<double>(k), -kQuarter}, 1e-6, 1e-4));
  }
  const PoseRelation& across = graph.graph().path.back();
  EXPECT_EQ(across.from, 0U);
  EXPECT_EQ(across.to, 3U);
  EXPECT_THAT(across.T_from_to, PoseNear({-2.0, -1.0, -kQuarter}, 1e-9, 1e-7));
  // Whichever way it is told, the same pose is as far off.
  const PoseRelation as_found{3, 0, inverse(across.T_from_to), loop_information(fix.evidence)};
  for (const Pose2& off : {Pose2{1e-4, 0.0, 0.0}, Pose2{0.0, 1e-4, 0.0}, Pose2{0.0, 0.0, 1e-4}}) {
    const Pose2 first = Pose2{0.3, 0.1, 0.7};
    const Pose2 second = first * across.T_from_to * off;
    const double expected = relation_chi2(as_found, second, first);
    EXPECT_NEAR(relation_chi2(across, first, second), expected, 0.001 * expected);
  }
}

// The pair that most fixes hold comes first; what one fix says against it is a loop that is off.
TEST(SiteGraph, SessionsAreLaidByThePairsThatMostHold) {
  const std::vector<Session> sessions{straight_on(3), straight_on(3), straight_on(3)};
  const std::vector<SessionEdge> edges{
      {0, 2, {fix_at(0, 0, {50.0, 0.0, 0.0}, 0.9)}},
      {0, 1, {fix_at(0, 0, {0.0, 4.0, 0.0}, 0.5), fix_at(2, 1, {2.0, 4.0, 0.0}, 0.5)}},
      {1,
       2,
       {fix_at(0, 0, {0.0, 4.0, 0.0}, 0.5), fix_at(1, 0, {1.0, 4.0, 0.0}, 0.5), fix_at(2, 1, {2.0, 4.0, 0.0}, 0.5)}}};
  const SiteGraph graph({0, 1, 2}, sessions, edges);
  EXPECT_THAT(graph.poses_of_sessions()[1][0], PoseNear({0.0, 4.0, 0.0}, 0.001, 0.01));
  EXPECT_THAT(graph.poses_of_sessions()[2][0], PoseNear({0.0, 8.0, 0.0}, 0.001, 0.01));
  EXPECT_EQ(graph.graph().path.size(), 5U);
  EXPECT_EQ(graph.loops_between(true), 5U);
  EXPECT_EQ(graph.loops_between(false), 1U);
}

// Of sessions that the group has not, edges say nothing; a session's own loops are none between sessions.
TEST(SiteGraph, OnlyWhatTheGroupHasCounts) {
  std::vector<Session> sessions{straight_on(3), straight_on(3), straight_on(3), straight_on(3)};
  sessions[2].loops.push_back({{0, 1, Pose2{2.0, 0.0, 0.0}, kSure}, 1.0});
  const std::vector<SessionEdge> edges{{0, 3, {fix_at(0, 0, {9.0, 9.0, 0.0}, 0.9)}},
                                       {1, 2, {fix_at(0, 1, {2.0, 1.0, 0.0}, 0.5)}}};
  const SiteGraph graph({1, 2}, sessions, edges);
  EXPECT_EQ(graph.graph().poses.size(), 4U);
  EXPECT_EQ(graph.graph().path.size(), 3U);
  EXPECT_EQ(graph.graph().loops.size(), 2U);
  EXPECT_EQ(graph.loops_between(true), 1U) << "from the last place of one to the first of the other";
  const PoseRelation& own = graph.graph().loops.front().relation;
  EXPECT_EQ(own.from, 2U);
  EXPECT_EQ(own.to, 3U);
}

TEST(SiteGraph, AsOneItHasAllKeyframesAKilometreOfPathApart) {
  const std::vector<Session> sessions{straight_on(3), straight_on(3)};
  const Session one = SiteGraph({0, 1}, sessions, {{0, 1, {fix_at(0, 0, {0.0, 5.0, 0.0}, 0.5)}}}).as_one();
  EXPECT_EQ(one.scans.size(), 6U);
  EXPECT_EQ(one.poses.size(), 6U);
  EXPECT_EQ(one.path_m, (std::vector<double>{0.0, 1.0, 2.0, 1002.0, 1003.0, 1004.0}));
  EXPECT_EQ(one.places, (std::vector<std::size_t>{0, 2, 3, 5}));
}

// Steps of one, and stretches of 4, 12 and 30 keyframes, four of each over every step as far as there are keyframes.
TEST(SiteGraph, ASessionHoldsItsOwnShape) {
  const Session curved = straight_on(31, {1.0, 2.0, 0.5});
  const std::vector<Session> sessions{curved, straight_on(12)};
  const auto count = [](const std::vector<PoseRelation>& held, std::size_t span) {
    return std::count_if(held.begin(), held.end(), [&](const PoseRelation& r) { return r.to - r.from == span; });
  };
  const std::vector<PoseRelation> alone = SiteGraph({0}, sessions, {}).held_relations();
  EXPECT_EQ(count(alone, 1), 30);
  EXPECT_EQ(count(alone, 4), 27);
  EXPECT_EQ(count(alone, 12), 7);
  EXPECT_EQ(count(alone, 30), 1);
  EXPECT_EQ(alone.size(), 65U);
  for (const PoseRelation& relation : alone) {
    EXPECT_THAT(relation.T_from_to, PoseNear({static_cast<double>(relation.to - relation.from), 0.0, 0.0}, 1e-9, 1e-7));
    EXPECT_NEAR(relation.information(0, 0), 625.0, 1e-9) << "a centimetre, one of 16";
    EXPECT_NEAR(relation.information(1, 1), 625.0, 1e-9);
    EXPECT_NEAR(relation.information(2, 2), 1.0 / 9.0e-6 / 16.0, 1e-6) << "three milliradians";
  }
  const std::vector<PoseRelation> both =
      SiteGraph({0, 1}, sessions, {{0, 1, {fix_at(0, 0, {0.0, 5.0, 0.0}, 0.5)}}}).held_relations();
  ASSERT_EQ(both.size(), 65U + 11U + 8U + 1U);
  const PoseRelation& fix = both.back();
  EXPECT_EQ(fix.from, 0U);
  EXPECT_EQ(fix.to, 31U) << "the first keyframe of the other";
  EXPECT_THAT(fix.T_from_to, PoseNear(between(Pose2{1.0, 2.0, 0.5}, Pose2{0.0, 5.0, 0.0}), 1e-9, 1e-9));
  for (std::size_t i = 0; i + 1 < both.size(); ++i) EXPECT_EQ(both[i].from < 31, both[i].to < 31);
}

// A site of two drives that is merged again: where one ends and the next begins nothing is known by driving.
TEST(SiteGraph, ASiteHoldsEachOfItsDrivesAlone) {
  const std::vector<Session> drives{straight_on(12), straight_on(9)};
  std::vector<Session> sites{SiteGraph({0, 1}, drives, {{0, 1, {fix_at(0, 0, {0.0, 5.0, 0.0}, 0.5)}}}).as_one()};
  const SiteGraph again({0}, sites, {});
  const std::vector<PoseRelation> held = again.held_relations();
  EXPECT_EQ(held.size(), 11U + 8U + 8U + 5U) << "steps and stretches of four of each";
  for (const PoseRelation& relation : held) EXPECT_EQ(relation.from < 12, relation.to < 12) << relation.from;
}

TEST(SiteGraph, ReturnsToTheFrameOfTheFirstSession) {
  const Pose2 first{1.0, 2.0, 0.5};
  const std::vector<Session> sessions{straight_on(3, first)};
  SiteGraph graph({0}, sessions, {});
  const Pose2 moved{0.3, -0.2, 0.1};
  for (Pose2& pose : graph.poses()) pose = moved * pose;
  graph.return_to_frame();
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_THAT(graph.poses()[k], PoseNear(sessions[0].poses[k], 1e-9, 1e-7));
  }
  EXPECT_THAT(graph.graph().poses[0], PoseNear(inverse(moved) * first, 1e-9, 1e-7)) << "which had not moved";
}

TEST(SiteGraph, CovariancesAreThoseOfPlacesAndTheirMeanBetween) {
  const std::vector<Session> sessions{straight_on(6)};
  const SiteGraph graph({0}, sessions, {});
  const std::vector<Matrix3> all = graph.covariances();
  ASSERT_EQ(all.size(), 6U);
  const std::vector<std::size_t> nodes{0, 1, 2};
  const std::vector<Matrix3> of_places = covariances_in_map(graph.graph(), nodes);
  for (int k = 0; k < 3; ++k) {
    EXPECT_DOUBLE_EQ(all[0](k, k), of_places[0](k, k));
    EXPECT_DOUBLE_EQ(all[2](k, k), of_places[1](k, k));
    EXPECT_DOUBLE_EQ(all[4](k, k), of_places[2](k, k));
    EXPECT_DOUBLE_EQ(all[3](k, k), 0.5 * (of_places[1](k, k) + of_places[2](k, k)));
    EXPECT_DOUBLE_EQ(all[5](k, k), of_places[2](k, k));
  }
}

TEST(AddEdges, JoinsThoseOfTheSameSessions) {
  std::vector<SessionEdge> edges{{0, 1, {fix_at(0, 0, {}, 0.5)}}};
  add_edges(edges, {{0, 1, {fix_at(1, 0, {}, 0.5), fix_at(2, 0, {}, 0.5)}},
                    {1, 0, {fix_at(3, 0, {}, 0.5)}},
                    {0, 2, {fix_at(4, 0, {}, 0.5)}},
                    {2, 1, {fix_at(5, 0, {}, 0.5)}}});
  ASSERT_EQ(edges.size(), 4U);
  ASSERT_EQ(edges[0].held.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(edges[0].held[k].keyframe, k);
  for (std::size_t k = 1; k < 4; ++k) {
    ASSERT_EQ(edges[k].held.size(), 1U);
    EXPECT_EQ(edges[k].held[0].keyframe, k + 2);
  }
}

TEST(GrowingSite, TellsPlacesOfTheSiteAsThoseOfItsSessions) {
  const std::vector<Session> sessions{straight_on(9), straight_on(4), straight_on(9), straight_on(4)};
  const SessionSearchOptions options;
  GrowingSite site({1, 3}, sessions, {{1, 3, {fix_at(0, 1, {2.0, 3.0, kQuarter}, 0.5)}}}, options);
  EXPECT_TRUE(site.holds(1));
  EXPECT_TRUE(site.holds(3));
  EXPECT_FALSE(site.holds(2));
  EXPECT_THAT(site.T_site_keyframe(1, 2), PoseNear({2.0, 0.0, 0.0}, 1e-6, 1e-4));
  EXPECT_THAT(site.T_site_keyframe(3, 2), PoseNear({2.0, 5.0, kQuarter}, 1e-6, 1e-4));
  const SessionEdge of_last = site.make_edge(2, fix_at(7, 1, {2.0, 1.0, 0.25}, 0.5));
  EXPECT_EQ(of_last.reference, 1U);
  EXPECT_EQ(of_last.query, 2U);
  EXPECT_EQ(of_last.held.front().reference_place, 1U);
  EXPECT_EQ(of_last.held.front().keyframe, 7U);
  EXPECT_THAT(of_last.held.front().T_map_keyframe, PoseNear({2.0, 1.0, 0.25}, 1e-6, 1e-4));
  const SessionEdge of_first = site.make_edge(2, fix_at(7, 2, {1.0, 3.0, kQuarter}, 0.5));
  EXPECT_EQ(of_first.reference, 3U);
  EXPECT_EQ(of_first.held.front().reference_place, 0U);
  EXPECT_THAT(of_first.held.front().T_map_keyframe, PoseNear({0.0, 1.0, 0.0}, 1e-6, 1e-4)) << "to its left";
}

// A metre of path is one place.
TEST(SessionOverlapOfAPlace, FindsAndRepeatsWhatLiesWithinAMetre) {
  const Session query = straight_on(6);
  SessionOverlap overlap;
  overlap.fixes = {fix_at(1, 0, {}, 0.5), fix_at(4, 0, {}, 0.5)};
  overlap.fixes[1].is_alone = false;
  EXPECT_TRUE(overlap.finds(query, 0));
  EXPECT_TRUE(overlap.finds(query, 2));
  EXPECT_TRUE(overlap.finds(query, 5));
  EXPECT_FALSE(overlap.repeats(query, 2)) << "there it is alone";
  EXPECT_TRUE(overlap.repeats(query, 3));
  EXPECT_TRUE(overlap.repeats(query, 5));
  overlap.fixes[0].is_possible = overlap.fixes[1].is_possible = false;
  EXPECT_FALSE(overlap.finds(query, 2));
  EXPECT_FALSE(overlap.repeats(query, 5));
  overlap.fixes = {fix_at(1, 0, {}, 0.5)};
  EXPECT_FALSE(overlap.finds(query, 3));
}

// Places at the first, the third and the last of five keyframes; of the way to the second place two sources tell.
TEST(SessionDoubts, AreSharesOfWhatThePathStates) {
  Session session;
  session.poses.resize(5);
  session.places = {0, 2, 4};
  const Matrix3 information = Matrix3::diagonal(100.0, 400.0, 1.0e4);
  session.path = {{0, 1, {}, information}, {0, 1, {}, 3.0 * information}};
  const std::vector<StepDoubt> doubts = doubts_by_path(session);
  ASSERT_EQ(doubts.size(), 5U);
  EXPECT_EQ(doubts[0].step(0, 0), 0.0);
  for (const std::size_t i : {1U, 2U}) EXPECT_NEAR(doubts[i].step(0, 0), 0.5 / 400.0, 1e-12);
  EXPECT_NEAR(doubts[2].step(2, 2), 0.5 / 4.0e4, 1e-15);
  EXPECT_EQ(doubts[3].step(0, 0), 0.0) << "nothing tells of that way";
}

}  // namespace
}  // namespace gdtslam

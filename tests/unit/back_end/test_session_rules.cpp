// What is asked of keyframes that are looked for in another session, at and beside each limit: in a room that is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/mapping/sessions/session_overlap.hpp"
#include "engine/mapping/sessions/session_search.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "loop_drive.hpp"

namespace gdtslam {
namespace {

using test::Segment;

/// Keyframes at these poses, each a place.
Session session_at(const std::vector<Segment>& walls, const std::vector<Pose2>& poses) {
  Session session;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    session.scans.push_back(keep_scan(points_of(test::scan_of(walls, poses[i], 0.0, 180), {})));
    session.poses.push_back(poses[i]);
    const double step_m = i > 0 ? (poses[i].translation() - poses[i - 1].translation()).norm() : 0.0;
    session.path_m.push_back(i > 0 ? session.path_m.back() + step_m : 0.0);
    session.places.push_back(i);
  }
  return session;
}

Session in_the_room(const std::vector<Pose2>& poses) { return session_at(test::furnished_room(), poses); }

/// What was seen to all sides.
std::vector<Pose2> looked_around() {
  std::vector<Pose2> poses;
  for (int k = 0; k < 6; ++k) poses.push_back({0.05 * k, 0.0, k * kPi / 3.0});
  return poses;
}

TEST(SessionRules, APlaceIsFoundWhereItIsAndNowhereElse) {
  const Session reference = in_the_room(looked_around());
  const Session query = in_the_room({{0.3, -0.2, 0.4}, {0.4, -0.2, 1.4}, {0.5, -0.2, 2.4}});
  const SessionMap map(reference, {});
  const SessionFix fix = map.find(query, 1);
  EXPECT_EQ(fix.keyframe, 1U);
  EXPECT_TRUE(fix.is_possible);
  EXPECT_TRUE(fix.is_alone);
  EXPECT_FALSE(fix.T_map_elsewhere);
  EXPECT_LT((fix.T_map_keyframe.translation() - query.poses[1].translation()).norm(), 0.05);
  EXPECT_LT(std::fabs(wrap_angle(fix.T_map_keyframe.theta_rad - query.poses[1].theta_rad)), 0.02);
  EXPECT_LT(fix.mean_m, 0.06);
  EXPECT_GE(fix.elsewhere_m, fix.mean_m + 0.03);
  EXPECT_TRUE(map.fits(query, fix, query.poses[1]));
  EXPECT_TRUE(map.fits(query, fix, query.poses[1] * Pose2{0.3, 0.0, 0.0})) << "a little beside";
  EXPECT_FALSE(map.fits(query, fix, query.poses[1] * Pose2{2.0, 0.0, 0.0}));
  EXPECT_FALSE(map.fits(query, fix, query.poses[1] * Pose2{0.0, 0.0, kPi}));
  EXPECT_FALSE(map.fits_elsewhere(query, fix, query.poses[1]));
  EXPECT_TRUE(map.fits_elsewhere(query, fix, query.poses[1] * Pose2{3.0, 0.0, 0.0})) << "it fits where it is";
  EXPECT_FALSE(map.find_elsewhere(query, 1, query.poses[1]));
  const auto elsewhere = map.find_elsewhere(query, 1, query.poses[1] * Pose2{3.0, 0.0, 0.0});
  ASSERT_TRUE(elsewhere);
  EXPECT_LT((elsewhere->translation() - query.poses[1].translation()).norm(), 0.05);
}

// A square room that is the same from each of its walls: four poses fit alike.
TEST(SessionRules, OfASquareRoomNothingTellsWhichWayItWas) {
  std::vector<Segment> walls;
  test::add_box(walls, {-3.013, -3.013}, {3.013, 3.013});
  const Session reference = session_at(walls, looked_around());
  const Session query = session_at(walls, {{0.4, 0.3, 0.2}, {0.4, 0.3, 2.2}, {0.4, 0.3, 4.2}});
  const SessionFix fix = SessionMap(reference, {}).find(query, 1);
  EXPECT_TRUE(fix.is_possible);
  EXPECT_FALSE(fix.is_alone);
  ASSERT_TRUE(fix.T_map_elsewhere);
  const double turned_rad = std::fabs(wrap_angle(fix.T_map_elsewhere->theta_rad - fix.T_map_keyframe.theta_rad));
  const double from_quarter_rad = std::fabs(wrap_angle(4.0 * turned_rad)) / 4.0;
  EXPECT_LT(from_quarter_rad, 0.03);
  EXPECT_GT(turned_rad, 1.0);
}

TEST(SessionRules, WhereItDidNotDriveASessionSaysNothing) {
  const Session reference = in_the_room({{0.0, 0.0, 0.0}});
  const Session query = in_the_room({{0.0, 0.0, 0.0}});
  const SessionMap map(reference, {});
  using Told = SessionMap::Test;
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_NE(map.test(query, 0, {sign * 1.49, 0.0, 0.0}), Told::kElsewhere);
    EXPECT_EQ(map.test(query, 0, {sign * 1.51, 0.0, 0.0}), Told::kElsewhere);
    EXPECT_EQ(map.test(query, 0, {0.0, sign * 1.51, 0.0}), Told::kElsewhere);
    EXPECT_EQ(map.test_walls(query, 0, {0.0, sign * 1.51, 0.0}), Told::kElsewhere);
  }
  EXPECT_EQ(map.test(query, 0, {}), Told::kFits);
  EXPECT_EQ(map.test(query, 0, {0.0, 0.0, 0.5 * kPi}), Told::kDoesNotFit);
  EXPECT_EQ(map.test_walls(query, 0, {}), Told::kFits);
  EXPECT_EQ(map.test_walls(query, 0, {0.0, 0.0, 0.5 * kPi}), Told::kDoesNotFit);
}

TEST(SessionRules, NoPathLeadsThroughAWall) {
  const Session reference = in_the_room(looked_around());
  const SessionMap map(reference, {});
  const Pose2 turned{0.013, 0.017, 0.3};  // in which the room's walls lie at -3 and 3, -2 and 6
  Session query;
  query.poses = {turned * Pose2{-1.0, 0.0, 0.0}, turned * Pose2{1.0, 0.0, 0.0}};
  EXPECT_FALSE(map.has_walls_in_the_way(query, {}));
  EXPECT_TRUE(map.has_walls_in_the_way(query, turned * Pose2{0.0, 0.0, kPi} * Pose2{1.5, 0.0, 0.0} * inverse(turned)))
      << "from -0.5 to -2.5, through the wall at -2";
  query.poses = {turned * Pose2{-1.0, -1.0, 0.0}, turned * Pose2{-1.0, -3.6, 0.0}};
  EXPECT_TRUE(map.has_walls_in_the_way(query, {}));
  query.poses = {turned * Pose2{500.0, 0.0, 0.0}, turned * Pose2{501.0, 0.0, 0.0}};
  EXPECT_FALSE(map.has_walls_in_the_way(query, {})) << "beyond all that it knows";
  query.poses.resize(1);
  EXPECT_FALSE(map.has_walls_in_the_way(query, {}));
}

TEST(SessionRules, OnePlaceIsAMetreOfPath) {
  Session session;
  session.path_m = {0.0, 1.0, 1.001};
  EXPECT_TRUE(are_at_one_place(session, 0, 1));
  EXPECT_TRUE(are_at_one_place(session, 1, 0));
  EXPECT_FALSE(are_at_one_place(session, 0, 2));
  EXPECT_FALSE(are_at_one_place(session, 2, 0));
}

/// Three keyframes 10 m apart on a line, each found there; the last one is off by so much.
std::size_t agreeing_where_the_last_is_off(const Pose2& off) {
  Session query;
  std::vector<SessionFix> fixes;
  for (std::size_t k = 0; k < 3; ++k) {
    query.poses.push_back({10.0 * static_cast<double>(k), 0.0, 0.0});
    query.path_m.push_back(10.0 * static_cast<double>(k));
    SessionFix fix;
    fix.keyframe = k;
    fix.is_alone = true;
    fix.T_map_keyframe = Pose2{3.0, 4.0, 1.0} * query.poses[k];
    if (k == 2) fix.T_map_keyframe = fix.T_map_keyframe * off;
    fixes.push_back(fix);
  }
  return agreeing(query, fixes).size();
}

// Of the first one, 20 m away: 10 cm and a hundredth of the way, a degree and half a milliradian a metre.
TEST(SessionRules, FixesAgreeUpToTheirDrift) {
  EXPECT_EQ(agreeing_where_the_last_is_off({}), 3U);
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(agreeing_where_the_last_is_off({sign * 0.299, 0.0, 0.0}), 3U);
    EXPECT_EQ(agreeing_where_the_last_is_off({sign * 0.301, 0.0, 0.0}), 0U);
    EXPECT_EQ(agreeing_where_the_last_is_off({0.0, sign * 0.299, 0.0}), 3U);
    EXPECT_EQ(agreeing_where_the_last_is_off({0.0, sign * 0.301, 0.0}), 0U);
    EXPECT_EQ(agreeing_where_the_last_is_off({0.0, 0.0, sign * (rad_from_deg(1.0) + 0.0099)}), 3U);
    EXPECT_EQ(agreeing_where_the_last_is_off({0.0, 0.0, sign * (rad_from_deg(1.0) + 0.0101)}), 0U);
  }
}

TEST(SessionRules, WallsAreCountedInSquaresOfHalfAMetre) {
  Session session;
  session.poses = {{10.0, 0.0, 0.5 * kPi}};
  session.scans.resize(1);
  // In the map: (9.75, 0.25), (9.6, 0.4) in one square, (9.75, 0.6) above and (10.1, 0.25) to the right of it.
  for (const Point2& p : {Point2(0.25, 0.25), Point2(0.4, 0.4), Point2(0.6, 0.25), Point2(0.25, -0.1)}) {
    session.scans[0].lone.push_back({static_cast<float>(p.x()), static_cast<float>(p.y())});
  }
  EXPECT_EQ(walls_of(session), 3U);
}

/// Ten places found, nine of them in one spot alone, five that agree, and nothing against them.
SessionOverlap joined() {
  return {.fixes = {},
          .possible = 10,
          .alone = 9,
          .explained = 9,
          .met = 20,
          .fitting = 18,
          .held = std::vector<SessionFix>(5)};
}

std::string rule_by_which_is_refused(SessionOverlap overlap) {
  const OverlapOptions options;
  refuse_doubtful(options, overlap);
  return rule_that_failed(options, overlap);
}

TEST(SessionRules, TheRuleThatFailedIsNamed) {
  SessionOverlap overlap = joined();
  overlap.held.clear();  // as a growing site does
  EXPECT_THAT(rule_by_which_is_refused(overlap), testing::HasSubstr("(rules 4 to 8)"));
  overlap.explained = 0;
  EXPECT_THAT(rule_by_which_is_refused(overlap), testing::HasSubstr("(rules 2 and 3)"));
  overlap = joined();
  overlap.alone = 7;
  EXPECT_EQ(rule_by_which_is_refused(overlap), "too many of them fit elsewhere as well (rule 4)");
  overlap = joined();
  overlap.rival = 3;
  EXPECT_EQ(rule_by_which_is_refused(overlap), "3 of them fit in another way to lay it, too (rule 4)");
  overlap = joined();
  overlap.fitting = 11;
  EXPECT_EQ(rule_by_which_is_refused(overlap), "of 20 places where both would have driven only 11 fit (rule 5)");
}

}  // namespace
}  // namespace gdtslam

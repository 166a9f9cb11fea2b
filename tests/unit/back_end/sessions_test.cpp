// Sessions joined, in worlds whose walls and poses are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/sites/session_merge.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "loop_drive.hpp"

namespace gdtslam {
namespace {

using test::Segment;

/// Of poses that are known; every sixteenth keyframe is a place. What a map's frame is, is the session's own matter.
Session session_of(const std::vector<Segment>& walls, const std::vector<Pose2>& truth, const Pose2& T_map_truth) {
  constexpr std::size_t kPlaceEvery = 16;
  Session session;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double step_m = i > 0 ? translation_length(between(truth[i - 1], truth[i])) : 0.0;
    session.scans.push_back(keep_scan(to_points(test::scan_of(walls, truth[i], 0.0, 180), {})));
    session.poses.push_back(T_map_truth * truth[i]);
    session.path_m.push_back(i > 0 ? session.path_m.back() + step_m : 0.0);
    if (i % kPlaceEvery != 0) continue;
    session.places.push_back(i);
    const std::size_t place = session.places.size() - 1;
    if (place == 0) continue;
    session.path.push_back({place - 1, place, between(truth[i - kPlaceEvery], truth[i]),
                            inverse(Matrix3::diagonal(1.0e-4, 1.0e-4, 1.0e-6))});
  }
  return session;
}

std::vector<Pose2> part_of(const std::vector<Pose2>& poses, double from, double to) {
  const auto at = [&](double share) { return poses.begin() + std::lround(share * static_cast<double>(poses.size())); };
  return {at(from), at(to)};
}

const std::vector<Segment>& rooms() {
  static const std::vector<Segment> walls = test::rooms_around_a_block();
  return walls;
}

const Pose2 kFirstFrame{3.0, -2.0, 0.4};
const Pose2 kSecondFrame{-40.0, 25.0, -2.5};

/// Two drives that have the middle of the round in common, each in a frame of its own.
std::vector<Session> two_drives() {
  const std::vector<Pose2> once = test::poses_around_ring(1);
  return {session_of(rooms(), part_of(once, 0.0, 0.65), kFirstFrame),
          session_of(rooms(), part_of(once, 0.35, 1.0), kSecondFrame)};
}

MergedSessions merged(const std::vector<Session>& sessions, unsigned threads = 1, const MergeOptions& options = {}) {
  WorkerPool workers(threads);
  return merge_sessions(sessions, options, workers, [](std::string_view, double) {});
}

TEST(Sessions, APlaceIsFoundInTheOther) {
  const std::vector<Session> sessions = two_drives();
  const SessionMap map(sessions[0], {});
  const Session& query = sessions[1];
  const std::size_t keyframe = query.places[2];
  const SessionFix fix = map.find(query, keyframe);
  const Pose2 truth = kFirstFrame * inverse(kSecondFrame) * query.poses[keyframe];
  EXPECT_TRUE(fix.is_possible);
  EXPECT_TRUE(fix.is_alone);
  EXPECT_LT(translation_length(between(truth, fix.T_map_keyframe)), 0.1);
  EXPECT_TRUE(map.fits(query, fix, truth));
  EXPECT_FALSE(map.fits(query, fix, truth * Pose2{0.0, 0.0, kPi})) << "the other way around";
  EXPECT_FALSE(map.find(query, query.places.back()).is_possible) << "the first drive was not there";
}

// Two rooms of one site 3.4 km apart: a grid of 0.1 m over both has more cells along a side than the transforms take.
TEST(Sessions, InASiteThatIsTooWideAreRefusedWithWhatToDo) {
  Session session = session_of(rooms(), part_of(test::poses_around_ring(1), 0.0, 0.1), {});
  session.poses.back().x_m += 3400.0;
  try {
    const SessionMap map(session, {});
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("merge those of one part of it"), std::string::npos) << error.what();
  }
}

// One and a half rounds: where it began, a robot saw what lay ahead of it alone, and when it came by again all around.
// A drive that ends there looked at it from behind.
TEST(Sessions, APlaceIsHeldAgainstTheTimeThatSawEnoughOfIt) {
  const Session session = session_of(rooms(), part_of(test::poses_around_ring(2), 0.25, 1.0), kFirstFrame);
  const std::vector<Pose2> drive = part_of(test::poses_around_ring(1), 0.3, 0.5);
  const Session query = session_of(rooms(), drive, kSecondFrame);
  const SessionMap map(session, {});
  const std::size_t end = query.poses.size() - 1;
  const Pose2 truth = kFirstFrame * drive[end];
  const LoopLimits limits = SessionSearchOptions{}.limits;
  EXPECT_LT(map.weigh(query, end, session.places.front(), truth).overlap, limits.least_overlap);
  const SessionFix fix = map.find(query, end);
  EXPECT_TRUE(fix.is_possible);
  EXPECT_GT(fix.reference_place, session.places.size() / 2);
  EXPECT_GE(fix.evidence.overlap, limits.least_overlap);
  EXPECT_LT(translation_length(between(truth, fix.T_map_keyframe)), 0.1);
}

TEST(Sessions, ThatOverlapBecomeOneSiteInTheFirstOnesFrame) {
  const std::vector<Pose2> once = test::poses_around_ring(1);
  const MergedSessions found = merged(two_drives());
  ASSERT_EQ(found.sites.size(), 1U);
  const MergedSite& site = found.sites.front();
  EXPECT_EQ(site.sessions, (std::vector<std::size_t>{0, 1}));
  EXPECT_GT(site.loops_between, 0U);
  EXPECT_EQ(site.loops_off, 0U);
  EXPECT_EQ(site.covariances.size(), site.poses[0].size() + site.poses[1].size());
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<Pose2> truth = k == 0 ? part_of(once, 0.0, 0.65) : part_of(once, 0.35, 1.0);
    for (Pose2& pose : truth) pose = kFirstFrame * pose;
    EXPECT_LT(test::largest_error_m(site.poses[k], truth), 0.05) << k;
  }
}

// Of each drive the part that the other did not see is cropped: its keyframes have no points left.
TEST(Sessions, WithKeyframesThatSawNothingAreJoinedByTheOthers) {
  std::vector<Session> sessions = two_drives();
  const std::size_t cropped = sessions[0].scans.size() / 3;
  for (std::size_t i = 0; i < cropped; ++i) {
    sessions[0].scans[i] = {};
    sessions[1].scans[sessions[1].scans.size() - 1 - i] = {};
  }
  const std::vector<Pose2> once = test::poses_around_ring(1);
  for (const unsigned threads : {1U, 2U}) {
    const MergedSessions found = merged(sessions, threads);
    ASSERT_EQ(found.sites.size(), 1U);
    for (std::size_t k = 0; k < 2; ++k) {
      std::vector<Pose2> truth = k == 0 ? part_of(once, 0.0, 0.65) : part_of(once, 0.35, 1.0);
      for (Pose2& pose : truth) pose = kFirstFrame * pose;
      EXPECT_LT(test::largest_error_m(found.sites.front().poses[k], truth), 0.1) << k;
    }
  }
  const SessionMap map(sessions[0], {});
  SessionFix blank;
  blank.keyframe = sessions[1].places.back();
  EXPECT_FALSE(map.fits_elsewhere(sessions[1], blank, kFirstFrame * once.back()));
}

TEST(Sessions, AreTheSameBitsForAnyNumberOfThreads) {
  const MergedSessions one = merged(two_drives(), 1);
  const MergedSessions three = merged(two_drives(), 3);
  ASSERT_EQ(one.sites.size(), three.sites.size());
  EXPECT_EQ(one.sites.front().poses, three.sites.front().poses);
  EXPECT_EQ(one.sites.front().covariances, three.sites.front().covariances);
}

TEST(Sessions, OfDifferentBuildingsStayApart) {
  const std::vector<Session> sessions{two_drives()[0],
                                      session_of(test::furnished_room(), test::drive_through_room(), {})};
  const MergedSessions found = merged(sessions);
  ASSERT_EQ(found.searches.size(), 1U);
  EXPECT_TRUE(found.edges.empty());
  ASSERT_EQ(found.sites.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(found.sites[k].sessions, std::vector<std::size_t>{k});
    EXPECT_EQ(found.sites[k].poses, std::vector<std::vector<Pose2>>{sessions[k].poses}) << "as they were";
  }
}

/// A corridor with the same niche every 5 m on both sides, and its ends out of sight.
std::vector<Segment> corridor_that_repeats() {
  std::vector<Segment> walls;
  test::add_box(walls, {-60.0, -1.2}, {60.0, 1.2});
  for (double x = -57.5; x < 60.0; x += 5.0) {
    test::add_box(walls, {x, -1.2}, {x + 0.6, -0.9});
    test::add_box(walls, {x, 0.9}, {x + 0.6, 1.2});
  }
  return walls;
}

std::vector<Pose2> straight(double from_m, double to_m) {
  std::vector<Pose2> poses;
  for (double x = from_m; x < to_m; x += 0.25) poses.push_back({x, 0.0, 0.0});
  return poses;
}

TEST(Sessions, OfABuildingThatRepeatsItselfAreNotJoined) {
  const std::vector<Segment> walls = corridor_that_repeats();
  const MergedSessions found =
      merged({session_of(walls, straight(-30.0, 10.0), {}), session_of(walls, straight(-10.0, 30.0), kSecondFrame)});
  const SessionOverlap& overlap = found.searches.front().overlap;
  EXPECT_GT(overlap.possible, 5U) << "its places are found,";
  EXPECT_LT(2 * overlap.alone, overlap.possible) << "and most of them in several spots";
  EXPECT_TRUE(found.edges.empty());
  EXPECT_EQ(found.sites.size(), 2U);
}

/// The rooms around the block as a hall, and two wings with the same corridor, whose frames these are: each is the
/// other turned by half a turn around the hall's middle.
const Pose2 kWing{60.0, 0.0, 0.3};
const Pose2 kOtherWing = Pose2{0.0, 0.0, kPi} * kWing;

std::vector<Segment> hall_with_alike_wings() {
  std::vector<Segment> walls = rooms();
  for (const Pose2& wing : {kWing, kOtherWing}) {
    for (const Segment& wall : test::ring_corridor()) walls.push_back({wing * wall.from, wing * wall.to});
  }
  return walls;
}

std::vector<Pose2> drive_in(const Pose2& wing, double from = 0.0, double to = 0.15) {
  std::vector<Pose2> poses = part_of(test::poses_around_ring(1), from, to);
  for (Pose2& pose : poses) pose = wing * pose;
  return poses;
}

std::vector<Pose2> one_after_the_other(std::vector<Pose2> poses, const std::vector<Pose2>& more) {
  poses.insert(poses.end(), more.begin(), more.end());
  return poses;
}

TEST(Sessions, InOneOfTwoAlikeWingsAreNotJoinedWhereBothAreKnown) {
  const std::vector<Segment> walls = hall_with_alike_wings();
  const std::vector<Pose2> once = test::poses_around_ring(1);
  const Session with_one =
      session_of(walls, one_after_the_other(part_of(once, 0.0, 0.9), drive_in(kWing)), kFirstFrame);
  const Session with_other =
      session_of(walls, one_after_the_other(part_of(once, 0.1, 1.0), drive_in(kOtherWing)), kSecondFrame);
  const Session in_wing = session_of(walls, drive_in(kWing), {});
  const MergedSessions found = merged({with_one, with_other, in_wing});
  ASSERT_EQ(found.sites.size(), 2U);
  EXPECT_EQ(found.sites[0].sessions, (std::vector<std::size_t>{0, 1})) << "by what they saw of the hall";
  EXPECT_EQ(found.sites[1].sessions, std::vector<std::size_t>{2}) << "it fits in both wings, each of which one saw";
  ASSERT_EQ(found.edges.size(), 1U);
  for (const SessionFix& fix : found.edges.front().held) {
    const bool is_of_second = found.edges.front().query == 1;
    const Session& query = is_of_second ? with_other : with_one;
    const Pose2 T_reference_query =
        is_of_second ? kFirstFrame * inverse(kSecondFrame) : kSecondFrame * inverse(kFirstFrame);
    EXPECT_LT(translation_length(between(T_reference_query * query.poses[fix.keyframe], fix.T_map_keyframe)), 0.1);
  }
  EXPECT_EQ(merged({with_one, in_wing}).sites.size(), 1U) << "nobody saw the other wing";
}

// A wing of which the site saw little holds a drive through it less well than its twin does, of which it saw all.
TEST(Sessions, ThatFitBestInTheTwinOfAWingThatWasHardlySeenAreNotJoined) {
  const std::vector<Segment> walls = hall_with_alike_wings();
  const std::vector<Pose2> once = test::poses_around_ring(1);
  const std::vector<Pose2> hardly_seen = part_of(drive_in(kOtherWing), 0.3, 0.75);
  const std::vector<Session> sessions{
      session_of(walls, one_after_the_other(part_of(once, 0.0, 0.9), drive_in(kWing)), kFirstFrame),
      session_of(walls, one_after_the_other(part_of(once, 0.1, 1.0), hardly_seen), kSecondFrame),
      session_of(walls, drive_in(kOtherWing), {})};
  const MergedSessions found = merged(sessions);
  ASSERT_EQ(found.sites.size(), 2U);
  EXPECT_EQ(found.sites[0].sessions, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(found.sites[1].sessions, std::vector<std::size_t>{2});
  const auto search = std::find_if(found.searches.begin(), found.searches.end(),
                                   [](const SessionSearch& each) { return each.query == 2; });
  ASSERT_NE(search, found.searches.end());
  EXPECT_TRUE(search->may_lie_elsewhere);
}

// What the site saw of both wings is alike, and the far end of one is all that it did not see: a drive there fits in
// the twin alone, and nothing that was seen speaks against the end that nobody saw.
TEST(Sessions, ThatFitInTheTwinOfWhatNobodySawAreNotJoined) {
  const std::vector<Segment> walls = hall_with_alike_wings();
  const std::vector<Pose2> once = test::poses_around_ring(1);
  const Session with_one =
      session_of(walls, one_after_the_other(part_of(once, 0.0, 0.9), drive_in(kWing, 0.0, 0.45)), kFirstFrame);
  const Session near_end =
      session_of(walls, one_after_the_other(part_of(once, 0.1, 1.0), drive_in(kOtherWing, 0.0, 0.2)), kSecondFrame);
  const Session hall = session_of(walls, part_of(once, 0.1, 1.0), kSecondFrame);
  const Session far_end = session_of(walls, drive_in(kOtherWing, 0.27, 0.43), {});
  const MergedSessions found = merged({with_one, near_end, far_end});
  ASSERT_EQ(found.sites.size(), 2U);
  EXPECT_EQ(found.sites[0].sessions, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(found.sites[1].sessions, std::vector<std::size_t>{2});
  EXPECT_EQ(merged({with_one, hall, far_end}).sites.size(), 1U) << "nobody saw that there is a twin";
}

/// Two wings with the same rooms around a block, at the ends of a hall of other rooms: theirs in a mirror.
std::vector<Segment> hall_with_alike_rooms() {
  std::vector<Segment> walls;
  for (const Segment& wall : rooms()) {
    walls.push_back({Point2(wall.from.x(), -wall.from.y()), Point2(wall.to.x(), -wall.to.y())});
    for (const Pose2& wing : {kWing, kOtherWing}) walls.push_back({wing * wall.from, wing * wall.to});
  }
  return walls;
}

std::vector<Pose2> in_a_mirror(std::vector<Pose2> poses) {
  for (Pose2& pose : poses) pose = {pose.x_m, -pose.y_m, -pose.theta_rad};
  return poses;
}

// The site saw another stretch of each wing, so each place of a drive fits in one of them alone, and there are two ways
// to lay the drive. What it has in common with a drive elsewhere in one of the wings does not tell which of them it is.
TEST(Sessions, ThatASiteHoldsInTwoWaysAreNotJoinedWithADriveThroughOneOfThem) {
  const std::vector<Segment> walls = hall_with_alike_rooms();
  const std::vector<Pose2> once = in_a_mirror(test::poses_around_ring(1));
  const Session with_one =
      session_of(walls, one_after_the_other(part_of(once, 0.0, 0.5), drive_in(kWing, 0.0, 0.15)), kFirstFrame);
  const Session with_other =
      session_of(walls, one_after_the_other(part_of(once, 0.1, 0.6), drive_in(kOtherWing, 0.2, 0.35)), kSecondFrame);
  const Session in_other = session_of(walls, drive_in(kOtherWing, 0.5, 0.75), kFirstFrame);
  const Session in_wing = session_of(walls, drive_in(kWing, 0.0, 0.7), {});
  const MergedSessions found = merged({with_one, with_other, in_other, in_wing});
  ASSERT_EQ(found.sites.size(), 3U);
  EXPECT_EQ(found.sites[0].sessions, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(merged({in_other, in_wing}).sites.size(), 1U) << "nobody saw that there are two";
}

// With a place in four of the longer drive where the shorter one was, the longer is not found in the shorter, but the
// shorter in the longer: when it is looked for once more, for others were joined by then.
TEST(Sessions, ThatWereJoinedWhileOthersAreLookedForOnceMoreAreNotLookedForAgain) {
  const std::vector<Pose2> once = test::poses_around_ring(1);
  std::vector<Pose2> away = straight(200.0, 290.0);
  for (Pose2& pose : away) pose.y_m = 300.0;
  const std::vector<Session> sessions{
      session_of(rooms(), part_of(once, 0.0, 0.4), {}), session_of(rooms(), part_of(once, 0.05, 0.35), kFirstFrame),
      session_of(rooms(), part_of(once, 0.6, 0.85), {}),
      session_of(rooms(), one_after_the_other(part_of(once, 0.6, 0.8), away), kSecondFrame)};
  MergeOptions options;
  options.overlap.search.most_places = 4;
  options.overlap.search.most_beside = 0;
  const MergedSessions found = merged(sessions, 1, options);
  const auto found_in = [&](std::size_t query, std::size_t reference) {
    return std::any_of(found.edges.begin(), found.edges.end(),
                       [&](const SessionEdge& edge) { return edge.query == query && edge.reference == reference; });
  };
  EXPECT_TRUE(found_in(2, 3)) << "and not the other way around";
  for (const SessionSearch& search : found.searches) {
    EXPECT_EQ(std::count(search.searched_in.begin(), search.searched_in.end(), search.query), 0) << search.query;
  }
  ASSERT_EQ(found.sites.size(), 2U);
  EXPECT_EQ(found.sites[0].sessions, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(found.sites[1].sessions, (std::vector<std::size_t>{2, 3}));
}

/// A session that stands every half metre on a line, and where it is said to lie.
struct OnALine {
  Session session;
  std::vector<SessionFix> fixes;
  OnALine() {
    for (std::size_t i = 0; i < 60; ++i) {
      session.poses.push_back({0.5 * static_cast<double>(i), 0.0, 0.0});
      session.path_m.push_back(0.5 * static_cast<double>(i));
    }
  }
  void add(std::size_t keyframe, const Pose2& off, bool is_alone = true) {
    SessionFix& fix = fixes.emplace_back();
    fix.keyframe = keyframe;
    fix.T_map_keyframe = kSecondFrame * session.poses[keyframe] * off;
    fix.is_possible = true;
    fix.is_alone = is_alone;
  }
};

TEST(AgreeingFixes, AreThreeWithinTenCentimetresAndADegree) {
  OnALine line;
  line.add(0, {});
  line.add(4, {0.08, 0.0, 0.0});
  EXPECT_TRUE(agreeing(line.session, line.fixes).empty()) << "two";
  line.add(8, {0.0, 0.0, rad_from_deg(3.0)});
  EXPECT_TRUE(agreeing(line.session, line.fixes).empty()) << "the third is turned by 3 degrees";
  line.add(12, {0.0, 0.5, 0.0});
  line.add(14, {}, false);
  EXPECT_TRUE(agreeing(line.session, line.fixes).empty()) << "half a metre away, and one that fits elsewhere too";
  line.add(16, {0.0, -0.05, rad_from_deg(-0.5)});
  EXPECT_EQ(agreeing(line.session, line.fixes), (std::vector<std::size_t>{0, 1, 5}));
}

TEST(PlacesToLookFor, AreSpreadAlongThePathFarOnesFirst) {
  Session session;
  session.places.resize(100);
  std::iota(session.places.begin(), session.places.end(), 0U);
  const std::vector<std::size_t> places = places_to_look_for(session, 40);
  ASSERT_EQ(places.size(), 40U);
  for (std::size_t k = 1; k < 10; ++k) EXPECT_EQ(places[k] - places[k - 1], 10U) << k;
  std::vector<std::size_t> sorted = places;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end()) << "none twice";
  EXPECT_EQ(places_to_look_for(session, 1000).size(), 100U);
}

TEST(KeyframesBeside, LieOnThePathToBothSides) {
  const OnALine line;
  EXPECT_EQ(keyframes_beside(line.session, 30), (std::vector<std::size_t>{24, 27, 33, 36}));
  EXPECT_EQ(keyframes_beside(line.session, 2), (std::vector<std::size_t>{5, 8})) << "the path begins a metre before";
}

}  // namespace
}  // namespace gdtslam

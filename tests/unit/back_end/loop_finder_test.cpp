// Which earlier places are searched, and what is kept of them until when: in a room that is seen again and again.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/mapping/loops/loop_finder.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

/// Three places 50 m of path apart, each a keyframe that saw nothing, in the middle of its group, and one 1 m ahead of
/// it that saw the room: where the group has walls is a matter of how the two lie to each other. The last one may be
/// at both others.
class RoomSeenAgain : public testing::Test {
 protected:
  RoomSeenAgain() {
    const std::vector<test::Segment> walls = test::furnished_room();
    for (const Pose2& seen_from : {Pose2{0.2, 0.1, 0.3}, Pose2{0.4, 0.3, 0.4}, Pose2{0.3, 0.0, 0.2}}) {
      graph_.poses.push_back(seen_from * Pose2{-1.0, 0.0, 0.0});
      poses_.insert(poses_.end(), {graph_.poses.back(), seen_from});
      scans_.emplace_back();
      scans_.push_back(keep_scan(to_points(test::scan_of(walls, seen_from, 0.0), {})));
      const double path_m = path_m_.empty() ? 0.0 : path_m_.back() + 49.0;
      path_m_.insert(path_m_.end(), {path_m, path_m + 1.0});
    }
    for (const std::size_t to : {1U, 2U}) {
      const Pose2 T = between(graph_.poses[to - 1], graph_.poses[to]);
      graph_.path.push_back({to - 1, to, T, Matrix3::diagonal(100.0, 100.0, 1.0e4)});
    }
  }

  void show_all_to(LoopFinder& finder) {
    finder.extend({scans_, poses_, path_m_});
    for (const std::size_t place : {0U, 2U, 4U}) finder.add_place(place);
  }
  /// The loops of the last place, those that were found at the places asked for.
  std::vector<Loop> look(LoopFinder& finder, std::size_t most = 4) { return finder.look(graph_, 2, most, alone_); }

  std::vector<KeptScan> scans_;
  std::vector<Pose2> poses_;
  std::vector<double> path_m_;
  PoseGraph graph_;
  WorkerPool alone_{1};
};

double off_m(const Loop& loop, const Pose2& T_from_to) {
  return translation_length(between(T_from_to, loop.relation.T_from_to));
}

TEST_F(RoomSeenAgain, BothEarlierPlacesAreFoundWhereTheyAre) {
  LoopFinder finder({});
  show_all_to(finder);
  const std::vector<Loop> loops = look(finder);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_NE(loops[0].relation.from, loops[1].relation.from);
  for (const Loop& loop : loops) {
    EXPECT_EQ(loop.relation.to, 2U);
    EXPECT_LT(off_m(loop, between(graph_.poses[loop.relation.from], graph_.poses[2])), 0.06);
    EXPECT_EQ(loop.weight, 1.0);
  }
  EXPECT_EQ(finder.counts().searched, 2U);
  EXPECT_EQ(finder.counts().found, 2U);
  EXPECT_GT(finder.counts().boxes, 0U);
}

// Little is known of the way there, least of all the heading: what covers such a window is not what the search may
// cost.
TEST_F(RoomSeenAgain, BoxesThatCoverTheWindowDoNotCount) {
  const Pose2 T_truth = between(graph_.poses[1], graph_.poses[2]);
  graph_.poses[2] = graph_.poses[2] * Pose2{0.4, -0.5, 0.6};
  for (PoseRelation& relation : graph_.path) {
    relation.T_from_to = between(graph_.poses[relation.from], graph_.poses[relation.to]);
    relation.information = Matrix3::diagonal(1.0, 1.0, 1.0);
  }
  LoopSearchOptions options;
  options.most_boxes = 1000;
  LoopFinder finder(options);
  show_all_to(finder);
  const std::vector<Loop> loops = look(finder, 1);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_LT(
      off_m(loops[0], loops[0].relation.from == 1 ? T_truth : between(graph_.poses[0], graph_.poses[1]) * T_truth),
      0.06);
  EXPECT_GT(finder.counts().boxes, 2 * options.most_boxes);
}

TEST_F(RoomSeenAgain, APlaceThatIsLeftOutIsNeitherLookedForNorAt) {
  LoopFinder finder({});
  show_all_to(finder);
  finder.leave_out(0);
  const std::vector<Loop> loops = look(finder);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops[0].relation.from, 1U);
  finder.leave_out(2);
  EXPECT_TRUE(look(finder).empty()) << "nor is anything looked for at such a place";
  EXPECT_EQ(finder.counts().searched, 1U);
}

TEST_F(RoomSeenAgain, WhatTheLimitsRefuseIsSearchedAndNotFound) {
  LoopSearchOptions options;
  options.limits.least_overlap = 1.01;
  LoopFinder finder(options);
  show_all_to(finder);
  EXPECT_TRUE(look(finder).empty());
  EXPECT_EQ(finder.counts().searched, 2U);
  EXPECT_EQ(finder.counts().found, 0U);
}

TEST_F(RoomSeenAgain, ALoopThatIsOnIsNotSearchedAgainAndOneThatIsOffIs) {
  LoopFinder finder({});
  show_all_to(finder);
  graph_.loops = look(finder);
  ASSERT_EQ(graph_.loops.size(), 2U);
  EXPECT_TRUE(look(finder).empty());
  EXPECT_EQ(finder.counts().searched, 2U) << "both are on";
  for (Loop& off : graph_.loops) {
    const std::uint64_t before = finder.counts().searched;
    off.weight = 0.25;  // at a quarter it is off
    const std::vector<Loop> again = look(finder);
    EXPECT_EQ(finder.counts().searched, before + 1);
    ASSERT_EQ(again.size(), 1U);
    EXPECT_EQ(again[0].relation.from, off.relation.from);
    off.weight = std::nextafter(0.25, 1.0);
    EXPECT_TRUE(look(finder).empty());
    EXPECT_EQ(finder.counts().searched, before + 1);
  }
}

// As a run has it where an edit has taken all readings out.
TEST_F(RoomSeenAgain, PlacesAroundWhichNothingWasSeenAreNeitherLookedForNorIn) {
  const std::vector<KeptScan> all = scans_;
  for (const std::size_t blank : {0U, 1U}) {
    scans_ = all;
    scans_[2 * blank + 1] = {};
    LoopFinder finder({});
    show_all_to(finder);
    const std::vector<Loop> loops = look(finder, 1);  // it takes no other one's turn
    ASSERT_EQ(loops.size(), 1U) << blank;
    EXPECT_EQ(loops[0].relation.from, 1 - blank);
    EXPECT_LT(off_m(loops[0], between(graph_.poses[1 - blank], graph_.poses[2])), 0.06);
    EXPECT_EQ(finder.counts().searched, 1U);
  }
  scans_ = all;
  scans_[5] = {};
  LoopFinder finder({});
  show_all_to(finder);
  EXPECT_TRUE(look(finder).empty());
  EXPECT_EQ(finder.counts().searched, 0U);
}

// The keyframes that saw the walls move 20 cm ahead. A group that was kept has them where they were, one that is made
// anew has them there.
TEST_F(RoomSeenAgain, GroupsBeyondTheMemoryAreForgottenAndOthersKeptUntilTheyAreBent) {
  const std::vector<Pose2> as_seen = poses_;
  const auto expect_walls_ahead_by = [&](double ahead_m, const std::vector<Loop>& loops, const char* when) {
    ASSERT_EQ(loops.size(), 2U) << when;
    for (const Loop& loop : loops) {
      const Pose2 T_seen_here = between(as_seen[2 * loop.relation.from + 1], graph_.poses[2]);
      EXPECT_LT(off_m(loop, Pose2{1.0 + ahead_m, 0.0, 0.0} * T_seen_here), 0.06) << when << ": " << loop.relation.from;
    }
  };
  for (const bool has_room : {true, false}) {
    LoopSearchOptions options;
    if (!has_room) options.most_bytes = 1;
    LoopFinder finder(options);
    poses_ = as_seen;
    show_all_to(finder);
    expect_walls_ahead_by(0.0, look(finder), "at first");
    for (const std::size_t seen : {1U, 3U}) poses_[seen] = poses_[seen - 1] * Pose2{1.2, 0.0, 0.0};
    expect_walls_ahead_by(has_room ? 0.0 : 0.2, look(finder), "again");
    finder.forget_bent();
    expect_walls_ahead_by(0.2, look(finder), "after those that are bent were forgotten");
  }
}

TEST_F(RoomSeenAgain, LookAtTellsOfEachPlaceInOrderForAnyNumberOfThreads) {
  for (const unsigned threads : {1U, 3U}) {
    LoopFinder finder({});
    show_all_to(finder);
    WorkerPool workers(threads);
    std::vector<std::pair<std::size_t, std::size_t>> told;
    const auto take = [&](std::size_t here, const std::vector<Loop>& loops) {
      told.emplace_back(here, loops.size());
      return false;
    };
    finder.look_at(graph_, 1, 3, workers, take);
    // The second place has the first before it, the third has both.
    EXPECT_EQ(told, (std::vector<std::pair<std::size_t, std::size_t>>{{1, 1}, {2, 2}})) << threads;
    EXPECT_EQ(finder.counts().searched, 3U);
    told.clear();
    finder.look_at(graph_, 2, 2, workers, take);
    EXPECT_TRUE(told.empty());
  }
}

/// A corridor whose niches repeat every 3 m, passed along 24 m in the middle of it, and then along 8 m of them.
class RepeatedNiches : public testing::Test {
 protected:
  RepeatedNiches() {
    std::vector<test::Segment> walls;
    for (const double side : {-1.0, 1.0}) {
      for (int k = -12; k < 12; ++k) {
        const double x = 3.0 * k;
        const std::vector<Point2> outline{{x, 1.2}, {x + 2.0, 1.2}, {x + 2.0, 1.7}, {x + 3.0, 1.7}, {x + 3.0, 1.2}};
        for (std::size_t i = 1; i < outline.size(); ++i) {
          walls.push_back({{outline[i - 1].x(), side * outline[i - 1].y()}, {outline[i].x(), side * outline[i].y()}});
        }
      }
    }
    for (const int half : {12, 4}) {
      for (int k = -half; k <= half; ++k) {
        poses_.push_back({1.0 * k, 0.0, 0.0});
        path_m_.push_back(half == 12 ? 12.0 + k : 104.0 + k);
        scans_.push_back(keep_scan(to_points(test::scan_of(walls, poses_.back(), 0.0), {})));
      }
    }
  }

  /// The loop that is found where the way along the corridor is known like this.
  std::vector<Loop> loops_with(double sigma_m) {
    PoseGraph graph;
    graph.poses = {poses_[12], poses_[29]};
    const double along = 1.0 / (sigma_m * sigma_m);
    graph.path.push_back({0, 1, between(poses_[12], poses_[29]), Matrix3::diagonal(along, 1.0e4, 1.0e6)});
    LoopFinder finder({});
    finder.extend({scans_, poses_, path_m_});
    finder.add_place(12);
    finder.add_place(29);
    WorkerPool alone(1);
    return finder.look(graph, 1, 4, alone);
  }

  std::vector<KeptScan> scans_;
  std::vector<Pose2> poses_;
  std::vector<double> path_m_;
};

TEST_F(RepeatedNiches, SayNothingAlongTheCorridorWhileTheWindowHoldsSeveral) {
  const std::vector<Loop> unsure = loops_with(2.0);
  ASSERT_EQ(unsure.size(), 1U);
  EXPECT_TRUE(unsure[0].is_ambiguous);
  const Matrix3 covariance = inverse(unsure[0].relation.information);
  EXPECT_GT(std::sqrt(covariance(0, 0)), 2.9) << "the next niche is 3 m away";
  EXPECT_LT(std::sqrt(covariance(1, 1)), 0.1) << "across the corridor all answers agree";
  const std::vector<Loop> sure = loops_with(0.1);
  ASSERT_EQ(sure.size(), 1U);
  EXPECT_FALSE(sure[0].is_ambiguous);
  EXPECT_LT(std::sqrt(inverse(sure[0].relation.information)(0, 0)), 0.1);
}

}  // namespace
}  // namespace gdtslam

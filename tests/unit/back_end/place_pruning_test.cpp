// Of a way that was gone often, the scans of later passes go: which, and that the path is as good without them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/mapping/adjust/scan_adjustment.hpp"
#include "engine/mapping/back_end/back_end.hpp"
#include "engine/mapping/loops/loop_closer.hpp"
#include "loop_drive.hpp"

namespace gdtslam {
namespace {

constexpr PruningRules kTwoPasses{.most_passes = 2, .near_m = 2.0, .near_rad = 0.5, .places_later = 1};

/// Asks after each of these poses, each tied by a loop to the first but where `weight` says otherwise, and the last
/// one, which is too new to be decided about.
std::vector<std::size_t> pruned_of(const std::vector<Pose2>& poses, const PruningRules& rules, double weight = 1.0) {
  PlacePruning pruning(rules);
  PoseGraph graph;
  std::vector<std::size_t> pruned;
  for (const Pose2& pose : poses) {
    graph.poses.push_back(pose);
    const std::size_t here = graph.poses.size() - 1;
    if (here > 0) graph.loops.push_back({.relation = {.from = 0, .to = here, .T_from_to = {}}, .weight = weight});
    if (const std::optional<std::size_t> place = pruning.next(graph)) pruned.push_back(*place);
  }
  return pruned;
}

TEST(PlacePruning, TheFirstPassesStayAndThoseBehindThemGo) {
  const std::vector<Pose2> standing(7, Pose2{3.0, -2.0, 0.4});
  EXPECT_EQ(pruned_of(standing, kTwoPasses), (std::vector<std::size_t>{2, 3, 4, 5}));
  PruningRules later = kTwoPasses;
  later.places_later = 3;
  EXPECT_EQ(pruned_of(standing, later), (std::vector<std::size_t>{2, 3}));
  later.most_passes = 3;
  EXPECT_EQ(pruned_of(standing, later), (std::vector<std::size_t>{3}));
}

TEST(PlacePruning, APlaceIsCrowdedBesideAsManyAsKeepTheirScans) {
  PlacePruning pruning(kTwoPasses);
  PoseGraph graph;
  for (std::size_t places = 1; places <= 5; ++places) {
    graph.poses.emplace_back();
    graph.loops.push_back({.relation = {.from = 0, .to = places - 1, .T_from_to = {}}, .weight = 1.0});
    (void)pruning.next(graph);
    EXPECT_EQ(pruning.is_crowded(graph, places - 1), places >= 3) << "two were decided about";
  }
  graph.poses.push_back({2.1, 0.0, 0.0});
  EXPECT_FALSE(pruning.is_crowded(graph, graph.poses.size() - 1));
}

TEST(PlacePruning, APlaceThatNoLoopHoldsStays) {
  const std::vector<Pose2> standing(6, Pose2{});
  EXPECT_TRUE(pruned_of(standing, kTwoPasses, 0.25).empty()) << "loops that are switched off";
  EXPECT_EQ(pruned_of(standing, kTwoPasses, 0.26).size(), 3U);
  PlacePruning pruning(kTwoPasses);
  PoseGraph graph;
  for (int k = 0; k < 6; ++k) {
    graph.poses.emplace_back();
    EXPECT_FALSE(pruning.next(graph)) << k;
  }
}

// A loop that was found at a later place ties it as well.
TEST(PlacePruning, ALoopFromThePlaceTiesIt) {
  PlacePruning pruning(kTwoPasses);
  PoseGraph graph;
  graph.poses.resize(3);
  EXPECT_FALSE(pruning.next({.poses = std::vector<Pose2>(2), .path = {}, .loops = {}}));
  EXPECT_FALSE(pruning.next(graph));
  graph.poses.resize(4);
  graph.loops.push_back({.relation = {.from = 2, .to = 3, .T_from_to = {}}, .weight = 1.0});
  EXPECT_EQ(pruning.next(graph), 2U);
}

TEST(CarryWithNearest, MovesEachPoseAsTheNearestOneMoved) {
  const std::vector<Pose2> before{{0.0, 0.0, 0.0}, {10.0, 0.0, 1.0}};
  const std::vector<Pose2> after{{0.5, -0.25, 0.1}, {10.0, 1.0, 0.9}};
  std::vector<Pose2> poses{{1.0, 2.0, 0.3}, {9.0, -1.0, -2.0}, {5.0, 0.0, 0.0}, {-3.9, 0.0, 0.0}, {-4.1, 0.0, 0.0}};
  const std::vector<Pose2> given = poses;
  carry_with_nearest(before, after, poses);
  const std::vector<std::optional<std::size_t>> nearest{0, 1, std::nullopt, 0, std::nullopt};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose2 expected = nearest[i] ? after[*nearest[i]] * inverse(before[*nearest[i]]) * given[i] : given[i];
    EXPECT_NEAR(poses[i].x_m, expected.x_m, 1.0e-12) << i;
    EXPECT_NEAR(poses[i].y_m, expected.y_m, 1.0e-12) << i;
    EXPECT_NEAR(poses[i].theta_rad, expected.theta_rad, 1.0e-12) << i;
  }
}

std::vector<std::pair<double, double>> sorted_points(const KeptScan& scan) {
  std::vector<std::pair<double, double>> points;
  for (const Point2& point : to_points(scan)) points.emplace_back(point.x(), point.y());
  std::sort(points.begin(), points.end());
  return points;
}

/// Five rounds of the ring by a front end that drifts, each fourth scan no keyframe.
class FiveRounds : public testing::Test {
 protected:
  static constexpr int kRounds = 5;
  static constexpr std::size_t kEveryOther = 4;

  static const test::LoopDrive& drive() {
    static const test::LoopDrive drive = test::drive_around_ring(kRounds, 0.005, 0.001, 7);
    return drive;
  }
  static BackEndOptions options(std::size_t most_passes, unsigned threads) {
    BackEndOptions options;
    options.loops.pruning.most_passes = most_passes;
    options.threads = threads;
    return options;
  }
  static void take(BackEnd& back_end, std::size_t scans) {
    Pose2 last = drive().path.poses.front();
    for (std::size_t i = 0; i < scans; ++i) {
      MatchResult result;
      result.T_map_base = drive().path.poses[i];
      result.T_map_predicted = result.T_map_base;
      result.T_odometry_step = between(last, result.T_map_base);
      result.odometry_sigma_m = result.predicted_sigma_m = 0.01;
      result.odometry_sigma_rad = result.predicted_sigma_rad = 0.002;
      result.accepted = true;
      result.merged = i % kEveryOther != 3;
      last = result.T_map_base;
      back_end.take(drive().path.scans[i], result);
    }
  }
  static void take_all(BackEnd& back_end) { take(back_end, drive().truth.size()); }
  /// In the frame of the first pose, as the back end tells them.
  static double largest_error_m(const std::vector<Pose2>& poses) {
    std::vector<Pose2> truth;
    for (const Pose2& pose : drive().truth) truth.push_back(between(drive().truth.front(), pose));
    return test::largest_error_m(poses, truth);
  }
};

TEST_F(FiveRounds, AreAsGoodWithTheScansOfTwoAsTwo) {
  BackEnd pruning(options(2, 1));
  take_all(pruning);
  const BackEndResult result = pruning.finish([](std::string_view, double) {});
  const std::vector<std::size_t>& kept = pruning.kept();
  ASSERT_LT(kept.size(), 3 * result.keyframes.size() / 4) << "two rounds, and what is too new";
  ASSERT_GT(kept.size(), result.keyframes.size() / kRounds);
  EXPECT_EQ(kept.front(), 0U);
  std::size_t visited = 0;
  pruning.visit_keyframes([&](std::size_t keyframe, const KeptScan& scan) {
    EXPECT_EQ(keyframe, visited++);
    EXPECT_EQ(sorted_points(scan), sorted_points(drive().path.scans[result.keyframes[keyframe]])) << keyframe;
  });
  EXPECT_EQ(visited, result.keyframes.size());
  ASSERT_EQ(result.poses.size(), drive().truth.size());
  BackEnd two_rounds(options(1000, 1));
  take(two_rounds, 2 * drive().truth.size() / kRounds);
  const BackEndResult of_two = two_rounds.finish([](std::string_view, double) {});
  EXPECT_EQ(two_rounds.kept().size(), of_two.keyframes.size());
  EXPECT_LT(largest_error_m(result.poses), 1.5 * largest_error_m(of_two.poses));
}

TEST_F(FiveRounds, GiveTheSameWithAnyNumberOfThreads) {
  std::vector<BackEndResult> results;
  std::vector<std::size_t> kept;
  for (const unsigned threads : {1U, 3U}) {
    BackEnd back_end(options(1, threads));
    take_all(back_end);
    results.push_back(back_end.finish([](std::string_view, double) {}));
    if (threads == 1) kept = back_end.kept();
    EXPECT_EQ(back_end.kept(), kept);
  }
  EXPECT_EQ(results[0].poses, results[1].poses);
  EXPECT_EQ(results[0].graph.poses, results[1].graph.poses);
}

}  // namespace
}  // namespace gdtslam

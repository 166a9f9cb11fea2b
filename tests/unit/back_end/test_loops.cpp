// Free space, verdicts and loops, in worlds whose walls and poses are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/mapping/loops/free_space.hpp"
#include "engine/mapping/loops/loop_closer.hpp"
#include "engine/mapping/loops/loop_verdict.hpp"
#include "engine/mapping/loops/revisits.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

using test::Segment;

void add_box(std::vector<Segment>& walls, const Point2& low, const Point2& high) {
  walls.push_back({low, {high.x(), low.y()}});
  walls.push_back({{high.x(), low.y()}, high});
  walls.push_back({high, {low.x(), high.y()}});
  walls.push_back({{low.x(), high.y()}, low});
}

/// A corridor around a block of 26 x 14 m, with niches at unequal distances, turned out of the grid.
std::vector<Segment> ring_corridor() {
  std::vector<Segment> walls;
  add_box(walls, {-15.0, -9.0}, {15.0, 9.0});
  add_box(walls, {-13.0, -7.0}, {13.0, 7.0});
  for (const double x : {-11.0, -6.5, -1.0, 2.0, 8.5}) add_box(walls, {x, -9.0}, {x + 0.5, -8.7});
  for (const double x : {-9.0, -3.5, 4.5, 6.0, 11.0}) add_box(walls, {x, 8.6}, {x + 0.6, 9.0});
  for (const double y : {-4.0, 1.5, 3.0}) add_box(walls, {14.7, y}, {15.0, y + 0.7});
  for (const double y : {-5.5, -1.0, 4.0}) add_box(walls, {-15.0, y}, {-14.6, y + 0.5});
  const Pose2 turned{0.011, 0.007, 0.21};
  for (Segment& wall : walls) wall = {turned * wall.from, turned * wall.to};
  return walls;
}

/// Along the middle of that corridor, a keyframe each 0.25 m or 10 degrees.
std::vector<Pose2> drive_around(int rounds) {
  const Pose2 turned{0.011, 0.007, 0.21};
  std::vector<Pose2> poses;
  Pose2 pose{-13.0, -8.0, 0.0};
  const auto straight = [&](double length_m) {
    for (int k = 0; k < static_cast<int>(std::lround(length_m / 0.25)); ++k) {
      poses.push_back(turned * pose);
      pose = pose * Pose2{0.25, 0.0, 0.0};
    }
  };
  const auto corner = [&] {
    for (int k = 0; k < 9; ++k) {
      poses.push_back(turned * pose);
      pose = pose * exp_se2({1.0 * kPi / 18.0, 0.0, kPi / 18.0});
    }
  };
  for (int round = 0; round < rounds; ++round) {
    straight(26.0);
    corner();
    straight(14.0);
    corner();
    straight(26.0);
    corner();
    straight(14.0);
    corner();
  }
  return poses;
}

/// Driven by wheels with this noise a step, where the truth is known.
struct LoopDrive {
  std::vector<Pose2> truth;
  FrontEndPath path;
};
LoopDrive drive(int rounds, double sigma_m, double sigma_rad, std::uint64_t seed) {
  Random random(seed);
  const std::vector<Segment> walls = ring_corridor();
  LoopDrive result;
  result.truth = drive_around(rounds);
  const Matrix3 information = inverse(Matrix3::diagonal(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad));
  for (std::size_t i = 0; i < result.truth.size(); ++i) {
    const LaserScan scan = test::scan_of(walls, result.truth[i], 0.0, 180);
    result.path.scans.push_back(keep_scan(points_of(scan, {})));
    if (i == 0) {
      result.path.poses.push_back(result.truth.front());
      result.path.path_m.push_back(0.0);
      result.path.steps.emplace_back();
      continue;
    }
    const Pose2 step = between(result.truth[i - 1], result.truth[i]);
    const double x = random.normal(0.0, sigma_m);
    const double y = random.normal(0.0, sigma_m);
    const double turn = random.normal(0.0, sigma_rad);
    const Pose2 measured = step * exp_se2({x, y, turn});
    result.path.poses.push_back(result.path.poses.back() * measured);
    result.path.steps.push_back({MeasuredStep{measured, information}, MeasuredStep{measured, 0.01 * information}});
    result.path.path_m.push_back(result.path.path_m.back() + step.translation().norm());
  }
  return result;
}

double largest_error_m(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    largest = std::max(largest, (poses[i].translation() - truth[i].translation()).norm());
  }
  return largest;
}

TEST(FreeSpace, IsWhatSeveralBeamsCrossedAndNothingStopped) {
  std::vector<Beam> beams;
  for (int k = -20; k <= 20; ++k) beams.push_back({{0.05, 0.05 + 0.02 * k}, {5.05, 0.05 + 0.02 * k}});
  const FreeSpace space(beams, {});
  EXPECT_TRUE(space.is_free({2.5, 0.05}));
  EXPECT_FALSE(space.is_free({5.05, 0.05})) << "the wall";
  EXPECT_FALSE(space.is_free({4.98, 0.05})) << "beside it";
  EXPECT_FALSE(space.is_free({2.5, 1.5})) << "nothing is known there";
  EXPECT_FALSE(space.is_free({1e6, -1e6}));
  EXPECT_TRUE(space.is_known({5.05, 0.05}));
  EXPECT_FALSE(space.is_known({5.6, 0.05}));
  EXPECT_FALSE(FreeSpace({}, {}).is_known({0.0, 0.0}));
}

TEST(LoopEvidence, SpeaksForTheRightPlaceAndAgainstOthers) {
  const LoopDrive twice = drive(2, 0.0, 0.0, 1);
  std::vector<double> path = twice.path.path_m;
  const KeyframePath keyframes{twice.path.scans, twice.truth, path};
  const std::size_t round = twice.truth.size() / 2;
  const ScanGroup reference(keyframes, 40, 9.0, 0.03);
  const ScanGroup query(keyframes, 40 + round, 4.0, 0.1);
  const Pose2 T = between(twice.truth[40], twice.truth[40 + round]);
  const LoopEvidence right = weigh_loop(reference, query, T);
  EXPECT_GT(right.overlap, 0.8);
  EXPECT_LT(right.contradiction, 0.02);
  EXPECT_EQ(right.turned, 0.0);
  EXPECT_TRUE(is_possible(right));
  EXPECT_FALSE(is_possible(weigh_loop(reference, query, T * Pose2{0.0, 0.7, 0.0}))) << "through the wall";
  EXPECT_FALSE(is_possible(weigh_loop(reference, query, T * Pose2{0.0, 0.0, 0.5 * kPi}))) << "across the corridor";
  const LoopEvidence behind = weigh_loop(reference, query, T * Pose2{0.0, 2.0, 0.0});
  EXPECT_GT(behind.turned, 0.3) << "one wall on the other's back";
}

TEST(Revisits, AreTheEarlierPlacesThatMayBeHere) {
  const LoopDrive twice = drive(2, 0.02, 0.002, 4);
  LoopCloser closer(twice.path, {});
  closer.follow([](double, int) {});
  PoseGraph graph;
  std::vector<double> path_m;
  for (const std::size_t keyframe : closer.places()) {
    graph.poses.push_back(twice.truth[keyframe]);
    path_m.push_back(twice.path.path_m[keyframe]);
    if (graph.poses.size() < 2) continue;
    const std::size_t to = graph.poses.size() - 1;
    graph.path.push_back(
        {to - 1, to, between(graph.poses[to - 1], graph.poses[to]), Matrix3::diagonal(2500.0, 2500.0, 250000.0)});
  }
  const GraphCovariance covariance(graph);
  const RevisitRules rules;
  std::size_t found = 0;
  for (std::size_t here = 0; here < graph.poses.size(); ++here) {
    for (const Revisit& revisit : revisits_of(graph, covariance, path_m, here)) {
      ++found;
      EXPECT_GE(path_m[here] - path_m[revisit.place], rules.least_path_m);
      const double away_m = (graph.poses[here].translation() - graph.poses[revisit.place].translation()).norm();
      EXPECT_LE(away_m, rules.near_m + rules.half_m(revisit));
      EXPECT_GT(revisit.sigma_m, 0.0);
    }
  }
  EXPECT_GT(found, graph.poses.size() / 3) << "each place of the second round";
}

class LoopCloserSeeds : public testing::TestWithParam<std::uint64_t> {};

TEST_P(LoopCloserSeeds, ClosesTheLoopsOfADriveThatDriftedApart) {
  const LoopDrive twice = drive(2, 0.01, 0.003, GetParam());
  LoopCloser closer(twice.path, {});
  double last_share = 0.0;
  int last_round = 0;
  closer.run([&](double share, int round) {
    EXPECT_TRUE(round > last_round || share > last_share);
    last_round = round;
    last_share = share;
  });
  const double before = largest_error_m(twice.path.poses, twice.truth);
  EXPECT_LT(largest_error_m(closer.poses(), twice.truth), std::max(0.15, 0.5 * before));
  std::size_t on = 0;
  for (const Loop& loop : closer.graph().loops) {
    if (!loop.is_on()) continue;
    ++on;
    const Pose2 true_relation =
        between(twice.truth[closer.places()[loop.relation.from]], twice.truth[closer.places()[loop.relation.to]]);
    const Pose2 off = between(true_relation, loop.relation.T_from_to);
    EXPECT_LT(off.translation().norm(), 0.3);
    EXPECT_LT(std::fabs(off.theta_rad), 0.05);
  }
  EXPECT_GT(on, 10U);
}
INSTANTIATE_TEST_SUITE_P(Seeds, LoopCloserSeeds, testing::Values(1, 2, 3, 4, 5));

// Groups that were dropped are made again from keyframes that have moved a little meanwhile.
TEST(LoopCloser, FindsAsMuchWhereOneGroupIsKeptAtATime) {
  const LoopDrive twice = drive(2, 0.01, 0.003, 2);
  LoopOptions narrow;
  narrow.search.most_bytes = 1;
  LoopCloser roomy(twice.path, {});
  LoopCloser cramped(twice.path, narrow);
  roomy.run([](double, int) {});
  cramped.run([](double, int) {});
  const auto found = [](const LoopCloser& closer) { return static_cast<double>(closer.graph().loops.size()); };
  EXPECT_GT(found(roomy), 10.0);
  EXPECT_NEAR(found(cramped), found(roomy), 0.1 * found(roomy));
  const double before = largest_error_m(twice.path.poses, twice.truth);
  EXPECT_LT(largest_error_m(cramped.poses(), twice.truth), std::max(0.15, 0.5 * before));
}

TEST(LoopCloser, APathWithoutRevisitsStaysAsItIs) {
  LoopDrive once = drive(1, 0.01, 0.003, 3);
  const std::size_t half = once.truth.size() / 2;
  once.path.scans.resize(half);
  once.path.poses.resize(half);
  once.path.path_m.resize(half);
  once.path.steps.resize(half);
  LoopCloser closer(once.path, {});
  closer.run([](double, int) {});
  EXPECT_TRUE(closer.graph().loops.empty());
  EXPECT_LT(largest_error_m(closer.poses(), once.path.poses), 1.0e-9);
}

}  // namespace
}  // namespace gdtslam

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
#include "loop_drive.hpp"

namespace gdtslam {
namespace {

using test::drive_around_ring;
using test::largest_error_m;
using test::LoopDrive;

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
  const LoopDrive twice = drive_around_ring(2, 0.0, 0.0, 1);
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

/// One keyframe that saw two walls along x, and where it says so one across, each a point every 5 cm.
KeptScan corridor_scan(double end_x) {
  KeptScan scan;
  const auto add = [&](double x, double y, double nx, double ny) {
    scan.surface.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(nx),
                            static_cast<float>(ny), static_cast<float>(pseudo_bearing(x, y))});
  };
  for (int k = -80; k <= 80; ++k) {
    add(0.05 * k, 1.02, 0.0, -1.0);
    add(0.05 * k, -1.02, 0.0, 1.0);
  }
  for (int k = -18; k <= 18 && end_x > 0.0; ++k) add(end_x, 0.05 * k, -1.0, 0.0);
  return scan;
}

// The way along a corridor is known where both have seen its end, not where one has.
TEST(LoopInformation, ComesFromTheWallsThatBothHave) {
  const auto information = [](double end_of_reference, double end_of_query) {
    const std::vector<KeptScan> scans{corridor_scan(end_of_reference), corridor_scan(end_of_query)};
    const std::vector<Pose2> poses(2);
    const std::vector<double> path_m{0.0, 100.0};
    const KeyframePath keyframes{scans, poses, path_m};
    const ScanGroup reference(keyframes, 0, 9.0, 0.03);
    const ScanGroup query(keyframes, 1, 4.0, 0.1);
    return loop_information(weigh_loop(reference, query, {}));
  };
  const Matrix3 both = information(3.5, 3.5);
  const Matrix3 one = information(0.0, 3.5);
  EXPECT_GT(both(0, 0), 0.1 * both(1, 1));
  EXPECT_LT(one(0, 0), 0.01 * both(0, 0));
  EXPECT_GT(one(1, 1), 0.5 * both(1, 1)) << "across it both know as much";
}

TEST(Revisits, AreTheEarlierPlacesThatMayBeHere) {
  const LoopDrive twice = drive_around_ring(2, 0.02, 0.002, 4);
  LoopCloser closer(twice.path, {});
  WorkerPool alone(1);
  closer.follow([](double, int) {}, alone);
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
    for (const Revisit& revisit : find_revisits(graph, covariance, path_m, here)) {
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
  const LoopDrive twice = drive_around_ring(2, 0.01, 0.003, GetParam());
  LoopCloser closer(twice.path, {});
  double last_share = 0.0;
  int last_round = 0;
  const auto progress = [&](double share, int round) {
    EXPECT_TRUE(round > last_round || share > last_share);
    last_round = round;
    last_share = share;
  };
  WorkerPool workers(2);
  closer.run(progress, workers);
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

// What is prepared for a search is the same each time, so nothing tells that it was dropped in between.
TEST(LoopCloser, FindsTheSameWhereNothingPreparedIsKept) {
  const LoopDrive twice = drive_around_ring(2, 0.002, 0.002, 5);
  LoopOptions narrow;
  narrow.search.most_prepared_bytes = 0;
  LoopCloser roomy(twice.path, {});
  LoopCloser cramped(twice.path, narrow);
  WorkerPool alone(1);
  roomy.run([](double, int) {}, alone);
  cramped.run([](double, int) {}, alone);
  EXPECT_FALSE(roomy.graph().loops.empty());
  EXPECT_EQ(roomy.counts().boxes, cramped.counts().boxes);
  ASSERT_EQ(roomy.poses().size(), cramped.poses().size());
  for (std::size_t k = 0; k < roomy.poses().size(); ++k) ASSERT_EQ(roomy.poses()[k], cramped.poses()[k]) << k;
}

// With room for all groups, for some and for one: what is looked for ahead may have to be looked for again.
TEST(LoopCloser, FindsTheSameWithAnyNumberOfThreads) {
  const LoopDrive twice = drive_around_ring(2, 0.01, 0.003, 2);
  for (const std::size_t most_bytes : {std::size_t{256} << 20U, std::size_t{4} << 20U, std::size_t{1}}) {
    LoopOptions options;
    options.search.most_bytes = most_bytes;
    LoopCloser by_one(twice.path, options);
    WorkerPool alone(1);
    by_one.run([](double, int) {}, alone);
    for (const unsigned threads : {2U, 5U}) {
      LoopCloser by_many(twice.path, options);
      WorkerPool workers(threads);
      by_many.run([](double, int) {}, workers);
      EXPECT_EQ(by_many.poses(), by_one.poses()) << threads << " threads, " << most_bytes << " bytes";
      EXPECT_EQ(by_many.counts().searched, by_one.counts().searched);
      EXPECT_EQ(by_many.counts().boxes, by_one.counts().boxes);
      EXPECT_EQ(by_many.counts().found, by_one.counts().found);
    }
  }
}

TEST(LoopCloser, APathWithoutRevisitsStaysAsItIs) {
  LoopDrive once = drive_around_ring(1, 0.01, 0.003, 3);
  const std::size_t half = once.truth.size() / 2;
  once.path.scans.keep(half);
  once.path.poses.resize(half);
  once.path.path_m.resize(half);
  once.path.steps.resize(half);
  LoopCloser closer(once.path, {});
  WorkerPool alone(1);
  closer.run([](double, int) {}, alone);
  EXPECT_TRUE(closer.graph().loops.empty());
  EXPECT_LT(largest_error_m(closer.poses(), once.path.poses), 1.0e-9);
}

}  // namespace
}  // namespace gdtslam

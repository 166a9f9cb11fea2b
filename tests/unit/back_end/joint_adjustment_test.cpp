// Scans of a room whose poses are known, moved away from them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/mapping/adjust/joint_adjustment.hpp"
#include "engine/mapping/adjust/scan_adjustment.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/adjusted_scan.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

LineScan seen_from(const Pose2& T_map_base) {
  return LineScan(keep_scan(to_points(test::scan_of(test::furnished_room(), T_map_base, 0.0, 360), {})));
}

double away_m(const Pose2& a, const Pose2& b) { return (a.translation() - b.translation()).norm(); }

/// A drive of keyframes about 0.2 m or 12 degrees apart.
struct PairedDrive {
  std::vector<Pose2> truth;
  std::vector<LineScan> scans;
};
PairedDrive keyframes() {
  PairedDrive drive;
  const std::vector<Pose2> poses = test::drive_through_room();
  for (std::size_t i = 0; i < poses.size(); i += 3) {
    drive.truth.push_back(poses[i]);
    drive.scans.push_back(seen_from(poses[i]));
  }
  return drive;
}

// The derivative of the cost by each of the three motions, against differences of the cost itself.
TEST(LineEquations, TheGradientIsThatOfTheDistances) {
  const Pose2 at{1.0, 0.2, 0.3};
  const LineScan fixed = seen_from(at);
  const Pose2 there = at * Pose2{0.15, -0.05, 0.08};
  const LineScan moving = seen_from(there);
  const LineGate gate{.most_m = 0.3, .points = 1000};  // so wide that a few millimetres count as their squares
  const Pose2 off = between(at, there) * exp_se2({0.004, -0.003, 0.002});
  const LineEquations lines = line_equations(fixed, moving, off, gate);
  ASSERT_GT(lines.weight, 100.0);
  for (int k = 0; k < 3; ++k) {
    Tangent2 step{};
    step[static_cast<std::size_t>(k)] = 1.0e-4;  // far above what float32 resolves
    const Tangent2 back{-step[0], -step[1], -step[2]};
    const double up = line_equations(fixed, moving, off * exp_tangent(step), gate).cost_m2;
    const double down = line_equations(fixed, moving, off * exp_tangent(back), gate).cost_m2;
    EXPECT_NEAR(lines.gradient[static_cast<std::size_t>(k)], 0.5 * (up - down) / 2.0e-4,
                0.02 * std::fabs(lines.gradient[static_cast<std::size_t>(k)]) + 1.0e-3);
  }
}

TEST(LineEquations, OppositeFacesOfAWallDoNotMeet) {
  std::vector<Point2> wall;
  for (int k = 0; k < 50; ++k) wall.emplace_back(1.0, -1.0 + 0.04 * k);
  const LineScan this_side(keep_scan(wall));
  const Pose2 from_behind{2.0, 0.0, 3.14159265358979};
  EXPECT_GT(line_equations(this_side, this_side, {}, {}).weight, 40.0);
  EXPECT_EQ(line_equations(this_side, this_side, from_behind, {}).weight, 0.0);
}

TEST(JointAdjustment, BringsKeyframesBackToWhereTheyWere) {
  const PairedDrive drive = keyframes();
  Random random(3);
  std::vector<Pose2> poses = drive.truth;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    poses[i] = poses[i] * exp_tangent({random.normal(0.0, 0.02), random.normal(0.0, 0.02), random.normal(0.0, 0.008)});
  }
  double before = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) before = std::max(before, away_m(poses[i], drive.truth[i]));
  WorkerPool alone(1);
  const JointResult result = JointAdjustment(drive.scans, {}, {}).run(poses, alone);
  EXPECT_GT(before, 0.03);
  EXPECT_LT(result.rms_m, 0.004);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT(away_m(poses[i], drive.truth[i]), 0.004) << i;
    EXPECT_LT(std::fabs(between(poses[i], drive.truth[i]).theta_rad), 0.002) << i;
  }
}

/// The same two walls along x whatever the robot's x, 40 points each, every fourth with a normal that is tilted by four
/// degrees: what a robot sees in a corridor in which nothing tells how far it went.
KeptScan corridor_with_tilted_normals() {
  KeptScan scan;
  for (const double side : {-1.0, 1.0}) {
    for (int k = 0; k < 40; ++k) {
      const double x = 0.1 * k - 1.0;
      const double tilt = k % 4 == 0 ? 0.07 : 0.0;
      scan.surface.push_back({static_cast<float>(x), static_cast<float>(side), static_cast<float>(std::sin(tilt)),
                              static_cast<float>(-side * std::cos(tilt)), static_cast<float>(pseudo_bearing(x, side))});
    }
  }
  std::sort(scan.surface.begin(), scan.surface.end(),
            [](const SurfacePoint& a, const SurfacePoint& b) { return a.direction < b.direction; });
  return scan;
}

TEST(JointAdjustment, TiltedNormalsPullNothingAlongACorridor) {
  const std::vector<LineScan> scans(6, LineScan(corridor_with_tilted_normals()));
  constexpr double kApart_m = 0.031;  // no sum of steps lies midway between two points
  std::vector<Pose2> poses;
  std::vector<PoseRelation> held;
  for (std::size_t i = 0; i < scans.size(); ++i) poses.push_back({kApart_m * static_cast<double>(i), 0.0, 0.0});
  for (std::size_t i = 1; i < scans.size(); ++i) {
    held.push_back({i - 1, i, {kApart_m, 0.0, 0.0}, Matrix3::diagonal(1.0e3, 1.0e3, 1.0e3)});  // 3 cm
  }
  WorkerPool alone(1);
  JointAdjustment(scans, held, {}).run(poses, alone);
  EXPECT_NEAR(between(poses.front(), poses.back()).x_m, 5.0 * kApart_m, 1.0e-6);
}

TEST(JointAdjustment, TheFirstKeyframeStays) {
  const PairedDrive drive = keyframes();
  std::vector<Pose2> poses = drive.truth;
  for (Pose2& pose : poses) pose = Pose2{5.0, -2.0, 0.7} * pose;
  const Pose2 first = poses.front();
  WorkerPool alone(1);
  JointAdjustment(drive.scans, {}, {}).run(poses, alone);
  EXPECT_LT(away_m(poses.front(), first), 1.0e-6);
}

TEST(JointAdjustment, WithoutKeyframesOrWithOneNothingHappens) {
  std::vector<Pose2> none;
  WorkerPool alone(1);
  EXPECT_EQ(JointAdjustment({}, {}, {}).run(none, alone).pairs, 0U);
}

TEST(JointAdjustment, GivesTheSameBitsForAnyNumberOfThreads) {
  const PairedDrive drive = keyframes();
  Random random(5);
  std::vector<Pose2> start = drive.truth;
  for (Pose2& pose : start) pose = pose * exp_tangent({random.normal(0.0, 0.02), random.normal(0.0, 0.02), 0.0});
  std::vector<Pose2> by_one = start;
  WorkerPool alone(1);
  const JointResult expected = JointAdjustment(drive.scans, {}, {}).run(by_one, alone);
  for (const unsigned threads : {2U, 7U}) {
    WorkerPool workers(threads);
    std::vector<Pose2> by_many = start;
    const JointResult result = JointAdjustment(drive.scans, {}, {}).run(by_many, workers);
    EXPECT_EQ(by_many, by_one) << threads;
    EXPECT_EQ(result.rms_m, expected.rms_m) << threads;
  }
}

// Against all pairs, looked at one by one.
TEST(PairsOf, AreThoseInTimeAndTheNearestInSpace) {
  Random random(11);
  std::vector<Pose2> poses;
  for (int i = 0; i < 300; ++i) poses.push_back({random.uniform() * 12.0, random.uniform() * 9.0, 0.0});
  const PairRules rules;
  std::vector<KeyframePair> expected;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const std::size_t back : rules.back) {
      if (i >= back) expected.emplace_back(i - back, i);
    }
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t j = 0; j + rules.back.back() < i; ++j) {
      if (away_m(poses[i], poses[j]) < rules.near_m) near.emplace_back(away_m(poses[i], poses[j]), j);
    }
    std::sort(near.begin(), near.end());
    for (std::size_t k = 0; k < std::min(near.size(), rules.most_near); ++k) expected.emplace_back(near[k].second, i);
  }
  EXPECT_EQ(find_pairs(poses), expected);
}

TEST(ScanAdjustment, PutsAScanBetweenItsKeyframes) {
  const PairedDrive drive = keyframes();
  const ScanAdjustment adjustment(drive.scans, drive.truth, {});
  const std::vector<Pose2> poses = test::drive_through_room();
  for (std::size_t i = 1; i < poses.size(); i += 7) {
    const Pose2 off = poses[i] * Pose2{0.012, -0.009, 0.006};
    const Pose2 adjusted = test::adjusted(adjustment, drive.scans, seen_from(poses[i]), off, i / 3);
    EXPECT_LT(away_m(adjusted, poses[i]), 0.5 * away_m(off, poses[i])) << i << ": a third is held by the pose given";
  }
}

}  // namespace
}  // namespace gdtslam

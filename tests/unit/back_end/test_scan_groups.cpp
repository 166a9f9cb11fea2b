// Groups of scans and what speaks for a loop between two of them: a few points each, all by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/mapping/loops/loop_verdict.hpp"
#include "engine/mapping/loops/scan_group.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

KeptScan scan_with(double x, double y, double nx, double ny) {
  KeptScan scan;
  scan.surface.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(nx), static_cast<float>(ny),
                          static_cast<float>(direction_of(x, y))});
  return scan;
}

void expect_point(const Point2& found, double x, double y) {
  EXPECT_NEAR(found.x(), x, 1e-6);
  EXPECT_NEAR(found.y(), y, 1e-6);
}

TEST(ScanGroups, PointsAndNormalsAreInTheFrameOfTheMiddle) {
  // The second keyframe stands at (2, 3) of the first and looks to the left: what is 1 m ahead of it lies at (2, 4),
  // and its normal, back to the robot, points down.
  std::vector<KeptScan> scans{scan_with(1.0, 0.5, 0.0, -1.0), scan_with(1.0, 0.0, -1.0, 0.0)};
  scans[1].lone.push_back({0.0F, 2.0F});
  const std::vector<Pose2> poses{{10.0, 20.0, 0.25 * kPi}, Pose2{10.0, 20.0, 0.25 * kPi} * Pose2{2.0, 3.0, 0.5 * kPi}};
  const std::vector<double> path_m{0.0, 4.0};
  const ScanGroup group({scans, poses, path_m}, 0, 4.0, 0.03);
  ASSERT_EQ(group.points().size(), 3U);
  expect_point(group.points()[0], 1.0, 0.5);
  expect_point(group.points()[1], 2.0, 4.0);
  expect_point(group.points()[2], 0.0, 3.0);
  ASSERT_EQ(group.space().walls().size(), 2U);
  expect_point(group.space().walls()[0].normal, 0.0, -1.0);
  expect_point(group.space().walls()[1].point, 2.0, 4.0);
  expect_point(group.space().walls()[1].normal, 0.0, -1.0);
  const ScanGroup from_second({scans, poses, path_m}, 1, 4.0, 0.03);
  expect_point(from_second.points()[1], 1.0, 0.0);
  EXPECT_EQ(ScanGroup({scans, poses, path_m}, 0, 3.999, 0.03).points().size(), 1U) << "beyond its half";
  EXPECT_EQ(ScanGroup({scans, poses, path_m}, 1, 3.999, 0.03).points().size(), 2U);
  EXPECT_EQ(ScanGroup({scans, poses, path_m}, 1, 4.0, 10.0).points().size(), 2U) << "one a cell";
}

// Three keyframes 10 cm apart see one wall, each some millimetres elsewhere.
TEST(ScanGroups, OfAWallThatSeveralSeeWhatTheMiddleSawCounts) {
  const std::vector<KeptScan> scans{scan_with(5.101, 0.02, -1.0, 0.0), scan_with(5.002, 0.02, -1.0, 0.0),
                                    scan_with(4.903, 0.02, -1.0, 0.0)};
  const std::vector<Pose2> poses{{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, {0.2, 0.0, 0.0}};
  const std::vector<double> path_m{0.0, 0.1, 0.2};
  const ScanGroup group({scans, poses, path_m}, 1, 4.0, 0.1);
  ASSERT_EQ(group.points().size(), 1U);
  expect_point(group.points()[0], 5.002, 0.02);
  ASSERT_EQ(group.space().walls().size(), 1U);
  EXPECT_EQ(group.space().walls()[0].keyframe, 1U);
}

TEST(ScanGroups, OfATurnOnTheSpotAreEightyToEachSide) {
  std::vector<KeptScan> scans;
  for (int k = 0; k < 200; ++k) scans.push_back(scan_with(1.0 + 0.1 * k, 0.0, -1.0, 0.0));
  const std::vector<Pose2> poses(200);
  const std::vector<double> path_m(200, 7.0);
  const ScanGroup group({scans, poses, path_m}, 100, 4.0, 0.03);
  ASSERT_EQ(group.points().size(), 161U);
  expect_point(group.points().front(), 3.0, 0.0);
  expect_point(group.points().back(), 19.0, 0.0);
}

// A wall at (2, 1) that looks along -y: J = (0, -1, 2 * -1 - 1 * 0).
TEST(ScanGroups, OneWallThatBothHaveHasTheShapeOfItsOwn) {
  const std::vector<KeptScan> scans{scan_with(2.0, 1.0, 0.0, -1.0)};
  const std::vector<Pose2> poses(1);
  const std::vector<double> path_m{0.0};
  const ScanGroup group({scans, poses, path_m}, 0, 4.0, 0.03);
  const LoopEvidence evidence = weigh_loop(group, group, {});
  EXPECT_EQ(evidence.overlap, 1.0);
  EXPECT_NEAR(evidence.shape(1, 1), 1.0, 1e-6);
  EXPECT_NEAR(evidence.shape(1, 2), 2.0, 1e-6);
  EXPECT_NEAR(evidence.shape(2, 2), 4.0, 1e-6);
  EXPECT_EQ(evidence.shape(0, 0), 0.0);
}

TEST(ScanGroups, AreBentBeyondTwoCentimetresOrThreeMilliradians) {
  const std::vector<KeptScan> scans(3, scan_with(1.0, 0.0, -1.0, 0.0));
  const std::vector<Pose2> poses{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}};
  const std::vector<double> path_m{0.0, 1.0, 2.0};
  const ScanGroup group({scans, poses, path_m}, 1, 4.0, 0.03);
  const auto is_bent = [&](const Pose2& last) {
    // All of them moved elsewhere, too, which bends nothing.
    const Pose2 T{30.0, -7.0, 2.0};
    return group.is_bent(std::vector<Pose2>{T * poses[0], T * poses[1], T * last});
  };
  EXPECT_FALSE(is_bent(poses[2]));
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_FALSE(is_bent({2.0 + sign * 0.0199, 0.0, 0.0}));
    EXPECT_TRUE(is_bent({2.0 + sign * 0.0201, 0.0, 0.0}));
    EXPECT_FALSE(is_bent({2.0, sign * 0.0199, 0.0}));
    EXPECT_TRUE(is_bent({2.0, sign * 0.0201, 0.0}));
    EXPECT_FALSE(is_bent({2.0, 0.0, sign * 0.0029}));
    EXPECT_TRUE(is_bent({2.0, 0.0, sign * 0.0031}));
  }
  EXPECT_TRUE(is_bent({2.015, 0.015, 0.0}));
}

/// A wall of 21 points across x, 10 cm apart, with one normal.
KeptScan wall_across(double x, double normal_rad) {
  KeptScan scan;
  for (int k = -10; k <= 10; ++k) {
    const double y = 0.1 * k + 0.05;
    const KeptScan one = scan_with(x, y, std::cos(normal_rad), std::sin(normal_rad));
    scan.surface.push_back(one.surface[0]);
  }
  return scan;
}

LoopEvidence evidence_of(const KeptScan& reference, const KeptScan& query, const Pose2& T) {
  const std::vector<KeptScan> scans{reference, query};
  const std::vector<Pose2> poses(2);
  const std::vector<double> path_m{0.0, 100.0};
  const KeyframePath keyframes{scans, poses, path_m};
  return weigh_loop(ScanGroup(keyframes, 0, 9.0, 0.03), ScanGroup(keyframes, 1, 4.0, 0.03), T);
}

TEST(LoopEvidenceOfWalls, AreOnOneAnotherWithinFifteenCentimetresAndSixtyDegrees) {
  const KeptScan wall = wall_across(2.05, kPi);
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(evidence_of(wall, wall, {sign * 0.14, 0.0, 0.0}).overlap, 1.0) << sign;
    EXPECT_EQ(evidence_of(wall, wall, {sign * 0.16, 0.0, 0.0}).overlap, 0.0) << sign;
    const double nearly_rad = sign * rad_from_deg(59.0);
    const double beyond_rad = sign * rad_from_deg(61.0);
    EXPECT_EQ(evidence_of(wall, wall_across(2.05, kPi + nearly_rad), {}).overlap, 1.0);
    const LoopEvidence across = evidence_of(wall, wall_across(2.05, kPi + beyond_rad), {});
    EXPECT_EQ(across.overlap, 0.0);
    EXPECT_EQ(across.turned, 0.0) << "neither side";
    const LoopEvidence behind = evidence_of(wall, wall_across(2.05, nearly_rad), {});
    EXPECT_EQ(behind.overlap, 0.0);
    EXPECT_EQ(behind.turned, 1.0);
    EXPECT_EQ(evidence_of(wall, wall_across(2.05, beyond_rad), {}).turned, 0.0);
  }
  // A quarter turn of the query puts a wall across y on it.
  KeptScan left;
  for (int k = -10; k <= 10; ++k) left.surface.push_back(scan_with(0.1 * k + 0.05, -2.05, 0.0, 1.0).surface[0]);
  EXPECT_EQ(evidence_of(wall, left, {0.0, 0.0, 0.5 * kPi}).overlap, 1.0);
  EXPECT_EQ(evidence_of(wall, left, {0.0, 0.0, -0.5 * kPi}).overlap, 0.0);
}

// A point at (x, y) with normal n tells (n_x, n_y, x n_y - y n_x): of a wall across x at y with its normal back, -1, 0
// and y. The mean of y over the points is 0.05, that of its square 0.01 * 770 / 21 + 0.0025.
TEST(LoopEvidenceOfWalls, ShapeIsThatOfOnePoint) {
  const KeptScan wall = wall_across(2.05, kPi);
  const LoopEvidence evidence = evidence_of(wall, wall, {});
  EXPECT_NEAR(evidence.shape(0, 0), 1.0, 1e-6);
  EXPECT_NEAR(evidence.shape(1, 1), 0.0, 1e-6);
  EXPECT_NEAR(evidence.shape(0, 2), -0.05, 1e-6);
  EXPECT_NEAR(evidence.shape(2, 2), 0.01 * 770.0 / 21.0 + 0.0025, 1e-6);
  EXPECT_EQ(evidence.contradiction, 0.0);
}

// 16 of the query's 24 wall cells lie on the reference's wall as it was seen, 5 on its back, 3 on none.
TEST(LoopEvidenceOfWalls, SharesAreThoseOfTheQuerysCells) {
  const KeptScan reference = wall_across(2.05, kPi);
  KeptScan query = wall_across(2.05, kPi);
  for (const std::size_t k : {0U, 3U, 4U, 10U, 20U}) query.surface[k].normal_x *= -1.0F;
  for (const double x : {-2.05, -2.25, -2.45}) query.surface.push_back(scan_with(x, 0.05, 1.0, 0.0).surface[0]);
  const LoopEvidence evidence = evidence_of(reference, query, {});
  EXPECT_DOUBLE_EQ(evidence.overlap, 16.0 / 24.0);
  EXPECT_DOUBLE_EQ(evidence.turned, 5.0 / 21.0);
}

TEST(LoopEvidenceOfWalls, OfAThinWallTheSideThatWasSeenCounts) {
  KeptScan both_sides = wall_across(2.05, kPi);
  const KeptScan back = wall_across(2.15, 0.0);
  both_sides.surface.insert(both_sides.surface.end(), back.surface.begin(), back.surface.end());
  for (const double x : {2.05, 2.15}) {
    for (const double normal_rad : {0.0, kPi}) {
      const LoopEvidence evidence = evidence_of(both_sides, wall_across(x, normal_rad), {});
      EXPECT_EQ(evidence.overlap, 1.0) << x << ' ' << normal_rad;
      EXPECT_EQ(evidence.turned, 0.0) << x << ' ' << normal_rad;
    }
  }
}

LonePoint lone_at(const Pose2& T, double x, double y) {
  const Point2 point = T * Point2{x, y};
  return {static_cast<float>(point.x()), static_cast<float>(point.y())};
}

// The reference looked three times along the middle of a row of cells, up to 5 m; of the query's points one lies in
// that row, one at its end, one nowhere.
TEST(LoopEvidenceOfSpace, APointOfTheQueryContradictsWhereTheReferenceLookedThrough) {
  KeptScan reference;
  for (int k = 0; k < 3; ++k) reference.lone.push_back(lone_at({}, 5.05, 0.05));
  const auto contradiction = [&](const std::vector<Point2>& points, const Pose2& T) {
    KeptScan query;
    for (const Point2& point : points) query.lone.push_back(lone_at(inverse(T), point.x(), point.y()));
    return evidence_of(reference, query, T).contradiction;
  };
  for (const Pose2& T : {Pose2{}, Pose2{0.3, -2.0, 0.5}, Pose2{0.3, 2.0, -0.5}}) {
    const Point2 through{2.55, 0.05};
    const Point2 end{5.05, 0.05};
    const Point2 nowhere{2.55, 3.05};
    // The reference's only point is where the query's last one is, so that both know it and it speaks for them.
    EXPECT_DOUBLE_EQ(contradiction({through, end, nowhere}, T), 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(contradiction({through, {2.75, 0.05}, end}, T), 2.0 / 4.0);
    EXPECT_DOUBLE_EQ(contradiction({end, nowhere}, T), 0.0);
  }
  EXPECT_EQ(contradiction({{-2.55, -3.05}}, {}), 0.0) << "nothing that both know";
}

// Now the query looked through, from another place and across; of the reference's nine points the first, the fifth and
// the last are asked, two of them in that row and one at its end, where the query's own point is.
TEST(LoopEvidenceOfSpace, EachFourthPointOfTheReferenceIsHeldAgainstTheQuery) {
  for (const Pose2& T : {Pose2{3.0, -2.0, 0.5 * kPi}, Pose2{-3.0, 2.0, -0.5 * kPi}}) {
    KeptScan query;
    for (int k = 0; k < 3; ++k) query.lone.push_back(lone_at({}, 5.05, 0.05));
    KeptScan reference;
    for (int k = 0; k < 8; ++k) reference.lone.push_back(lone_at(T, 1.05 + 0.3 * k, 0.05));
    reference.lone.push_back(lone_at(T, 5.05, 0.05));
    EXPECT_DOUBLE_EQ(evidence_of(reference, query, T).contradiction, 2.0 / 4.0);
  }
}

TEST(LoopLimits, AreReachedAndNotPassed) {
  EXPECT_TRUE(is_possible({.overlap = 0.3, .turned = 0.1, .contradiction = 0.08}));
  EXPECT_FALSE(is_possible({.overlap = 0.2999, .turned = 0.1, .contradiction = 0.08}));
  EXPECT_FALSE(is_possible({.overlap = 0.3, .turned = 0.1001, .contradiction = 0.08}));
  EXPECT_FALSE(is_possible({.overlap = 0.3, .turned = 0.1, .contradiction = 0.0801}));
  EXPECT_FALSE(is_possible({.overlap = 0.0, .turned = 0.0, .contradiction = 0.0}));
}

// 60 points at full overlap, each known to 5 cm, less what tilted normals feign and a few walls tell (0.02 of a shape);
// never better than 3 cm and 6 mrad.
TEST(LoopInformationOfWalls, IsThatOfThePointsUpToItsFloor) {
  const auto expected = [](double shape, double overlap, double floor) {
    return 1.0 / (1.0 / (60.0 * overlap / 0.0025 * (shape - 0.02)) + floor * floor);
  };
  for (const double overlap : {1.0, 0.5}) {
    const Matrix3 information = loop_information({.overlap = overlap, .shape = Matrix3::diagonal(0.04, 0.4, 2.0)});
    EXPECT_NEAR(information(0, 0), expected(0.04, overlap, 0.03), 1e-3);
    EXPECT_NEAR(information(1, 1), expected(0.4, overlap, 0.03), 1e-3);
    EXPECT_NEAR(information(2, 2), expected(2.0, overlap, 0.006), 0.1);
    EXPECT_NEAR(information(0, 1), 0.0, 1e-6);
  }
  const Matrix3 none = loop_information({.overlap = 1.0, .shape = Matrix3::diagonal(0.015, 0.4, 2.0)});
  EXPECT_LT(none(0, 0), 1e-5) << "so little is nothing";
  EXPECT_GT(none(0, 0), 1e-7) << "and still positive";
}

}  // namespace
}  // namespace gdtslam

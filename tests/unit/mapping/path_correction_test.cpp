// Corrections of a planar path: points and poses against the transforms written out, and knots on clocks that jump.
#include "engine/mapping/strokes/path_correction.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kFirstScan = 40;
constexpr double kHighest_rad = 0.8;

/// A bend of 6 s with an axis off the robot's centre; corrections at random.
PathCorrection draw_correction(Random& random, double elevation_rad) {
  PlanarPath path{.poses = {}, .first_scan = kFirstScan, .axis_base_m = {0.2, 0.1, 0.6}};
  for (int k = 0; k < 120; ++k) path.poses.push_back({100.0 + 0.05 * k, {0.03 * k, 1.0e-4 * k * k, 0.05 * k - 2.0}});
  PathCorrection correction(path, -kHighest_rad, kHighest_rad);
  for (Tangent3& knot : correction.knots) {
    for (double& value : knot) value = random.normal(0.0, 0.05);
  }
  for (double& knot : correction.elevation_knots_rad) knot = random.normal(0.0, elevation_rad);
  return correction;
}

Point3 space_position(const CloudPoint& point) {
  return Eigen::Vector3f(point.x_m, point.y_m, point.z_m).cast<double>();
}

Cloud draw_points(Random& random, const PathCorrection& correction) {
  Cloud cloud;
  for (std::uint32_t k = 0; k < 120; ++k) {
    for (int n = 0; n < 5; ++n) {
      const auto draw = [&](double half) { return static_cast<float>(random.uniform(-half, half)); };
      cloud.push_back(
          {draw(5.0), draw(5.0), draw(2.0), draw(kHighest_rad), correction.path().poses[k].stamp_s, kFirstScan + k});
    }
  }
  return cloud;
}

// correct() turns by the elevation's correction to first order: of a turn by a at d metres, a^2 d / 2 is left out.
TEST(PathCorrection, PointsAtTheStampOfTheirScanAreCorrectedAsOneByOne) {
  Random random(1);
  for (const double elevation_rad : {0.0, 0.002}) {
    const PathCorrection correction = draw_correction(random, elevation_rad);
    const Cloud before = draw_points(random, correction);
    Cloud after = before;
    correction.correct(after);
    const double allowed_m = 2.0e-6 + 0.5 * std::pow(3.5 * elevation_rad, 2) * 12.0;
    double moved_m = 0.0;
    for (std::size_t k = 0; k < before.size(); ++k) {
      const PathCorrection::Moment moment = correction.at_scan(static_cast<double>(before[k].scan));
      const Point3 expected =
          correction.corrected(space_position(before[k]), static_cast<double>(before[k].elevation_rad), moment);
      EXPECT_LT((space_position(after[k]) - expected).norm(), allowed_m) << k;
      moved_m = std::max(moved_m, (expected - space_position(before[k])).norm());
    }
    EXPECT_GT(moved_m, 0.1);
  }
}

// A lift by the same angle everywhere is a turn of the points about the axis, which lies to the robot's left.
TEST(PathCorrection, LiftsPointsAboutTheAxisOfTheMount) {
  PathCorrection correction({.poses = {{0.0, {1.0, 2.0, 0.0}}}, .first_scan = 0, .axis_base_m = {0.2, 0.0, 0.6}}, -1.0,
                            1.0);
  for (double& knot : correction.elevation_knots_rad) knot = 0.1;
  const Point3 ahead(1.2 + 3.0 * std::cos(0.3), 2.0, 0.6 + 3.0 * std::sin(0.3));
  const Point3 expected(1.2 + 3.0 * std::cos(0.4), 2.0, 0.6 + 3.0 * std::sin(0.4));
  EXPECT_LT((correction.corrected(ahead, 0.3, correction.at_scan(0.0)) - expected).norm(), 1.0e-12);
}

// The robot's own points move with its pose: T_map_base by poses() takes them where correct() does.
TEST(PathCorrection, PosesAreTheCorrectionAfterThePlanarPose) {
  Random random(2);
  const PathCorrection correction = draw_correction(random, 0.0);
  const std::vector<Pose3> poses = correction.poses();
  ASSERT_EQ(poses.size(), 120U);
  for (std::uint32_t k = 0; k < 120; ++k) {
    const Point3 in_base(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(-1.0, 1.0));
    const PathCorrection::Moment moment = correction.at_scan(kFirstScan + k);
    const Point3 planar = embed(correction.path().poses[k].T_map_base) * in_base;
    EXPECT_LT((poses[k] * in_base - correction.corrected(planar, 0.0, moment)).norm(), 1.0e-12);
    const Tangent3 by = correction.correction(moment);
    const Eigen::AngleAxisd turn(by.tail<3>().norm(), by.tail<3>().normalized());
    const Eigen::AngleAxisd yaw(correction.path().poses[k].T_map_base.theta_rad, Point3::UnitZ());
    EXPECT_LT((rotation_matrix(poses[k].rotation) - (turn * yaw).toRotationMatrix()).norm(), 1.0e-12);
  }
}

// Between the stamps of a scan's points the correction goes on at its rate: at the next scan's stamp it is the next's.
TEST(PathCorrection, PointsLaterInAScanTakeTheCorrectionOfTheirTime) {
  Random random(3);
  PathCorrection correction = draw_correction(random, 0.0);
  for (Tangent3& knot : correction.knots) knot.tail<3>().setZero();  // shifts are linear in time
  for (std::uint32_t k = 1; k < 9; ++k) {                            // scans between the first two knots
    Cloud cloud{{1.0F, 2.0F, 0.5F, 0.0F, correction.path().poses[k + 1].stamp_s, kFirstScan + k}};
    correction.correct(cloud);
    const Tangent3 by = correction.correction(correction.at_scan(kFirstScan + k + 1));
    EXPECT_LT((space_position(cloud[0]) - Point3(1.0, 2.0, 0.5) - by.head<3>()).norm(), 1.0e-6) << k;
  }
}

TEST(PathCorrection, KnotsCoverAllScansWhenTheClockJumps) {
  for (const double jump_s : {0.0, 3600.0, -3600.0, -0.01}) {
    PlanarPath path;
    for (int k = 0; k < 200; ++k) path.poses.push_back({0.1 * k + (k >= 90 ? jump_s : 0.0), {0.1 * k, 0.0, 0.0}});
    const PathCorrection correction(path, -0.5, 0.5);
    EXPECT_GE(correction.knots.size(), 20.0 / 0.5) << jump_s;  // half a second apart
    EXPECT_LE(correction.knots.size(), 20.0 / 0.5 + 4.0) << jump_s;
    double last = -1.0;
    for (int k = 0; k < 200; ++k) {
      const PathCorrection::Moment moment = correction.at_scan(k);
      ASSERT_LT(moment.knot + 1, correction.knots.size());
      EXPECT_GE(moment.share, 0.0);
      EXPECT_LE(moment.share, 1.0);
      const double now = static_cast<double>(moment.knot) + moment.share;
      EXPECT_GT(now, last) << k;  // in time
      last = now;
    }
    for (std::size_t k = 0; k + 1 < correction.knots.size(); ++k) EXPECT_GE(correction.step_s(k), 0.5 - 1.0e-9);
  }
}

}  // namespace
}  // namespace gdtslam

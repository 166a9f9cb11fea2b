// Poses between two fixes: paper equation (13) in its three readings, values from geometry.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/mapping/nodding/pose_path.hpp"
#include "gdtslam/core/angle.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

PoseFix fix(const Pose2& T_map_base, const Pose2& T_odom_base = {}) { return {0.0, T_map_base, T_odom_base}; }

/// The pose at the end of an arc of a length.
Pose2 arc(double length_m, double turn_rad) {
  const double radius = length_m / turn_rad;
  return {radius * std::sin(turn_rad), radius * (1.0 - std::cos(turn_rad)), turn_rad};
}

double apart_m(const Pose2& to) {
  const Pose2 a = interpolate(PoseInterpolation::kLinear, fix({}), fix(to), 0.5, {});
  const Pose2 b = interpolate(PoseInterpolation::kGeodesic, fix({}), fix(to), 0.5, {});
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

// A chord and its arc: the sagitta, 6.5 mm for 0.3 m and 10 degrees, 187 mm for 1 m and 90 degrees.
TEST(PoseInterpolation, LinearAndGeodesicDifferByTheSagitta) {
  EXPECT_NEAR(apart_m(arc(0.3, rad_from_deg(10.0))), 0.0065, 0.00005);
  EXPECT_NEAR(apart_m(arc(1.0, rad_from_deg(90.0))), 0.187, 0.001);
  const double radius = 1.0 / rad_from_deg(90.0);
  EXPECT_NEAR(apart_m(arc(1.0, rad_from_deg(90.0))), radius * (1.0 - std::cos(rad_from_deg(45.0))), 1.0e-12);
  EXPECT_NEAR(apart_m({2.0, 1.0, 0.0}), 0.0, 1.0e-12);
}

TEST(PoseInterpolation, GeodesicStaysOnTheCircle) {
  const Pose2 start{3.0, -2.0, 0.7};
  const Pose2 end = start * arc(1.5, 1.2);
  for (const double share : {0.1, 0.25, 0.5, 0.9}) {
    const Pose2 found = interpolate(PoseInterpolation::kGeodesic, fix(start), fix(end), share, {});
    EXPECT_THAT(found, PoseNear(start * arc(1.5 * share, 1.2 * share), 1.0e-12, 1.0e-12));
  }
}

TEST(PoseInterpolation, LinearScalesEachCoordinateAndTurnsTheShortWay) {
  const Pose2 from{1.0, 2.0, rad_from_deg(170.0)};
  const Pose2 to{3.0, 6.0, rad_from_deg(-170.0)};
  EXPECT_THAT(interpolate(PoseInterpolation::kLinear, fix(from), fix(to), 0.25, {}),
              PoseNear({1.5, 3.0, rad_from_deg(175.0)}, 1.0e-12, 1.0e-12));
  EXPECT_THAT(interpolate(PoseInterpolation::kLinear, fix(from), fix(to), 0.75, {}),
              PoseNear({2.5, 5.0, rad_from_deg(-175.0)}, 1.0e-12, 1.0e-12));
}

// Straight ahead, then a quarter turn on the spot: neither a line nor one arc. The fixes are those of the wheels, in
// another frame.
TEST(PoseInterpolation, OdometryFollowsTheWheelsWhereTheFixesAgree) {
  const Pose2 T_map_odom{5.0, -1.0, 2.0};
  const Pose2 ahead{1.0, 0.0, 0.0};
  const Pose2 turned{1.0, 0.0, rad_from_deg(90.0)};
  const PoseFix from = fix(T_map_odom, {});
  const PoseFix to = fix(T_map_odom * turned, turned);
  for (const double share : {0.0, 0.3, 0.5, 1.0}) {
    EXPECT_THAT(interpolate(PoseInterpolation::kOdometry, from, to, share, ahead),
                PoseNear(T_map_odom * ahead, 1.0e-12, 1.0e-12));
  }
}

// Wheels that travel 10 % too far: the surplus is taken back by time.
TEST(PoseInterpolation, OdometrySpreadsTheResidualByTime) {
  const PoseFix from = fix({});
  const PoseFix to = fix({1.0, 0.2, 0.0}, {1.1, 0.2, 0.0});
  const Pose2 found = interpolate(PoseInterpolation::kOdometry, from, to, 0.5, {0.44, 0.1, 0.0});
  EXPECT_THAT(found, PoseNear({0.44 - 0.05, 0.1, 0.0}, 1.0e-12, 1.0e-12));
  EXPECT_THAT(interpolate(PoseInterpolation::kOdometry, from, to, 1.0, to.T_odom_base),
              PoseNear(to.T_map_base, 1.0e-12, 1.0e-12));
}

}  // namespace
}  // namespace gdtslam

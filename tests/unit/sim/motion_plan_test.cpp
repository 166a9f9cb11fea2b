// Plans on paper: lengths, times and places that follow from the limits.
#include "gdtslam/sim/motion_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

MotionLimits limits() {
  return {.speed_m_per_s = 1.0,
          .acceleration_m_per_s2 = 0.5,
          .turn_rate_rad_per_s = 1.0,
          .turn_acceleration_rad_per_s2 = 2.0,
          .corner_cut_m = 0.5,
          .spin_above_rad = 2.0};
}

Waypoint at(double x, double y) {
  Waypoint waypoint;
  waypoint.position_m = {x, y};
  return waypoint;
}

TEST(MotionPlan, StraightLegIsATrapezoid) {
  const MotionPlan plan({at(1.0, 2.0), at(1.0, 12.0)}, limits());
  // 2 s and 1 m of rising, 8 m at 1 m/s, 2 s and 1 m of falling.
  EXPECT_NEAR(plan.duration_s(), 12.0, 1e-12);
  EXPECT_NEAR(plan.path_m(), 10.0, 1e-12);
  const MotionState early = plan.state_at(1.0);
  EXPECT_NEAR(early.T_map_axle.y_m, 2.25, 1e-12);
  EXPECT_NEAR(early.T_map_axle.theta_rad, 0.5 * kPi, 1e-15);
  EXPECT_NEAR(early.speed_m_per_s, 0.5, 1e-12);
  EXPECT_NEAR(plan.state_at(6.0).T_map_axle.y_m, 7.0, 1e-12);
  EXPECT_NEAR(plan.state_at(11.0).T_map_axle.y_m, 11.75, 1e-12);
  EXPECT_NEAR(plan.state_at(99.0).T_map_axle.y_m, 12.0, 1e-12);
  EXPECT_EQ(plan.state_at(-1.0).T_map_axle.y_m, 2.0);
}

TEST(MotionPlan, SharpCornersAndZeroCutsAreTurnedOnTheSpot) {
  Waypoint corner = at(5.0, 0.0);
  corner.corner_cut_m = 0.0;
  const MotionPlan plan({at(0.0, 0.0), corner, at(5.0, 5.0), at(5.0, 1.0)}, limits());
  EXPECT_NEAR(plan.path_m(), 14.0, 1e-12);
  const MotionState end = plan.state_at(plan.duration_s());
  EXPECT_NEAR(end.T_map_axle.x_m, 5.0, 1e-9);
  EXPECT_NEAR(end.T_map_axle.y_m, 1.0, 1e-9);
  EXPECT_NEAR(end.T_map_axle.theta_rad, -0.5 * kPi, 1e-9);
  // A left quarter, then half a turn either way.
  EXPECT_NEAR(std::fabs(end.turned_rad - 0.5 * kPi), kPi, 1e-9);
  // Spin by pi/2 at 1 rad/s and 2 rad/s^2: 0.5 s up, 0.5 s down, the rest of the angle at full rate.
  const double first_spin_s = 7.0;  // the leg of 5 m takes 2 + 3 + 2 s
  EXPECT_NEAR(plan.state_at(first_spin_s).T_map_axle.theta_rad, 0.0, 1e-9);
  EXPECT_NEAR(plan.state_at(first_spin_s + 0.5 * kPi + 0.5).T_map_axle.theta_rad, 0.5 * kPi, 1e-9);
  EXPECT_NEAR(plan.state_at(first_spin_s + 0.5).turn_rate_rad_per_s, 1.0, 1e-9);
}

TEST(MotionPlan, RoundedCornerLeavesAndMeetsTheLegsAtItsCut) {
  const MotionPlan plan({at(0.0, 0.0), at(5.0, 0.0), at(5.0, 5.0)}, limits());
  bool has_turned = false;
  for (double t = 0.0; t < plan.duration_s(); t += 0.01) {
    const MotionState state = plan.state_at(t);
    const Pose2& T = state.T_map_axle;
    if (T.x_m < 4.5 - 1e-9) {
      EXPECT_NEAR(T.y_m, 0.0, 1e-12);
    } else if (T.y_m > 0.5 + 1e-9) {
      EXPECT_NEAR(T.x_m, 5.0, 1e-12);
      EXPECT_NEAR(T.theta_rad, 0.5 * kPi, 1e-9);
    } else {
      has_turned = true;
      // Symmetric about the corner's bisector, and inside of the corner.
      EXPECT_LE(T.x_m, 5.0 + 1e-9);
      EXPECT_GE(T.y_m, -1e-9);
      EXPECT_LE(state.turn_rate_rad_per_s, 1.0 + 1e-9);
    }
  }
  EXPECT_TRUE(has_turned);
  EXPECT_LT(plan.path_m(), 10.0);
  EXPECT_GT(plan.path_m(), 9.0 + 0.5 * std::sqrt(2.0));
}

TEST(MotionPlan, ReverseLegIsDrivenWithTheBackAhead) {
  Waypoint back = at(1.0, 0.0);
  back.is_reverse = true;
  const MotionPlan plan({at(0.0, 0.0), at(3.0, 0.0), back}, limits());
  const MotionState end = plan.state_at(plan.duration_s());
  EXPECT_NEAR(end.T_map_axle.x_m, 1.0, 1e-12);
  EXPECT_NEAR(end.T_map_axle.theta_rad, 0.0, 1e-12);
  EXPECT_NEAR(end.travelled_m, 1.0, 1e-12);
  EXPECT_NEAR(end.path_m, 5.0, 1e-12);
  EXPECT_LT(plan.state_at(plan.duration_s() - 1.0).speed_m_per_s, 0.0);
}

TEST(MotionPlan, PausesAndSpeedsOfWaypointsCount) {
  Waypoint first = at(0.0, 0.0);
  first.pause_s = 2.0;
  Waypoint second = at(4.0, 0.0);
  second.speed_m_per_s = 0.5;
  second.pause_s = 3.0;
  const MotionPlan plan({first, second}, limits());
  // 1 s up, 1 s down (0.25 m each), 3.5 m at 0.5 m/s.
  EXPECT_NEAR(plan.duration_s(), 2.0 + 1.0 + 7.0 + 1.0 + 3.0, 1e-12);
  EXPECT_EQ(plan.state_at(1.5).path_m, 0.0);
  EXPECT_NEAR(plan.state_at(12.0).path_m, 4.0, 1e-12);
  EXPECT_EQ(plan.state_at(12.0).speed_m_per_s, 0.0);
  const std::vector<Stand> stands = plan.stands();
  ASSERT_EQ(stands.size(), 2U);
  EXPECT_EQ(stands[0].from_s, 0.0);
  EXPECT_EQ(stands[0].duration_s, 2.0);
  EXPECT_NEAR(stands[1].from_s, 11.0, 1e-12);
  EXPECT_EQ(stands[1].duration_s, 3.0);
}

TEST(MotionPlan, RefusesWhatCannotBeDriven) {
  EXPECT_THROW(MotionPlan({at(0.0, 0.0)}, limits()), ConfigError);
  EXPECT_THROW(MotionPlan({at(0.0, 0.0), at(0.0, 0.001)}, limits()), ConfigError);
  EXPECT_THROW(MotionPlan({at(0.0, 0.0), at(std::nan(""), 0.0)}, limits()), ConfigError);
  Waypoint slow = at(1.0, 0.0);
  slow.speed_m_per_s = 0.0;
  EXPECT_THROW(MotionPlan({at(0.0, 0.0), slow}, limits()), ConfigError);
  MotionLimits wrong = limits();
  wrong.acceleration_m_per_s2 = -1.0;
  wrong.turn_rate_rad_per_s = std::nan("");
  EXPECT_EQ(validate(wrong).size(), 2U);
  EXPECT_THROW(MotionPlan({at(0.0, 0.0), at(1.0, 0.0)}, wrong), ConfigError);
  EXPECT_THROW(MotionPlan({at(0.0, 0.0), at(1e5, 0.0)}, MotionLimits{.speed_m_per_s = 0.1}), ConfigError);
  const std::vector<Waypoint> longer_than_a_day = {at(-1000.0, 0.0), at(1000.0, 0.0)};
  EXPECT_THROW(MotionPlan(longer_than_a_day, MotionLimits{.speed_m_per_s = 0.02}), ConfigError);
}

}  // namespace
}  // namespace gdtslam::sim

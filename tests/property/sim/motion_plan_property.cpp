// Laws of motion on random paths: limits hold, nothing jumps, and pose, speeds and travel tell one story.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/sim/motion_plan.hpp"

namespace gdtslam::sim {
namespace {

std::vector<Waypoint> random_waypoints(Random& random) {
  std::vector<Waypoint> waypoints;
  const std::uint64_t count = 2 + random.below(8);
  for (std::uint64_t i = 0; i < count; ++i) {
    Waypoint waypoint;
    do {  // a plan refuses waypoints that are closer than 1 cm
      waypoint.position_m = {random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0)};
    } while (!waypoints.empty() && (waypoint.position_m - waypoints.back().position_m).norm() < 0.02);
    if (random.uniform() < 0.3) {
      waypoint.corner_cut_m = random.uniform() < 0.5 ? 0.0 : random.uniform(0.01, 3.0);
    }
    if (random.uniform() < 0.2) {
      waypoint.speed_m_per_s = random.uniform(0.1, 2.0);
    }
    waypoint.pause_s = random.uniform() < 0.2 ? random.uniform(0.0, 1.0) : 0.0;
    waypoint.is_reverse = random.uniform() < 0.3;
    waypoints.push_back(waypoint);
  }
  return waypoints;
}

MotionLimits random_limits(Random& random) {
  return {.speed_m_per_s = random.uniform(0.2, 1.5),
          .acceleration_m_per_s2 = random.uniform(0.1, 2.0),
          .turn_rate_rad_per_s = random.uniform(0.2, 2.0),
          .turn_acceleration_rad_per_s2 = random.uniform(0.3, 4.0),
          .corner_cut_m = random.uniform(0.0, 1.0),
          .spin_above_rad = random.uniform(0.5, 2.6)};
}

RC_GTEST_PROP(MotionPlan, KeepsItsLimitsAndNeverJumps, (std::uint64_t seed)) {
  Random random(seed);
  const std::vector<Waypoint> waypoints = random_waypoints(random);
  const MotionLimits limits = random_limits(random);
  const MotionPlan plan(waypoints, limits);
  constexpr double kStep_s = 3e-3;
  constexpr double kSlack = 1e-6;
  MotionState before = plan.state_at(0.0);
  for (double t = kStep_s; t < plan.duration_s(); t += kStep_s) {
    const MotionState now = plan.state_at(t);
    RC_ASSERT(std::fabs(now.speed_m_per_s) <= limits.speed_m_per_s + kSlack);
    RC_ASSERT(std::fabs(now.turn_rate_rad_per_s) <= limits.turn_rate_rad_per_s + kSlack);
    RC_ASSERT(std::fabs(now.speed_m_per_s - before.speed_m_per_s) <= limits.acceleration_m_per_s2 * kStep_s + kSlack);
    RC_ASSERT(std::fabs(now.turn_rate_rad_per_s - before.turn_rate_rad_per_s) <=
              limits.turn_acceleration_rad_per_s2 * kStep_s + kSlack);
    // Pose against speeds, by the midpoint rule over one step.
    const MotionState middle = plan.state_at(t - 0.5 * kStep_s);
    const double heading = middle.T_map_axle.theta_rad;
    RC_ASSERT(std::fabs(now.T_map_axle.x_m - before.T_map_axle.x_m -
                        middle.speed_m_per_s * std::cos(heading) * kStep_s) < 2e-5);
    RC_ASSERT(std::fabs(now.T_map_axle.y_m - before.T_map_axle.y_m -
                        middle.speed_m_per_s * std::sin(heading) * kStep_s) < 2e-5);
    RC_ASSERT(std::fabs(now.travelled_m - before.travelled_m - middle.speed_m_per_s * kStep_s) < 2e-5);
    RC_ASSERT(std::fabs(now.turned_rad - before.turned_rad - middle.turn_rate_rad_per_s * kStep_s) < 2e-5);
    RC_ASSERT(std::fabs(wrap_angle(now.T_map_axle.theta_rad - before.T_map_axle.theta_rad -
                                   (now.turned_rad - before.turned_rad))) < 1e-9);
    RC_ASSERT(std::fabs(now.path_m - before.path_m - std::fabs(now.travelled_m - before.travelled_m)) < 2e-5);
    before = now;
  }
}

RC_GTEST_PROP(MotionPlan, BeginsAtTheFirstAndEndsAtTheLastWaypoint, (std::uint64_t seed)) {
  Random random(seed);
  const std::vector<Waypoint> waypoints = random_waypoints(random);
  const MotionPlan plan(waypoints, random_limits(random));
  const Pose2 start = plan.state_at(0.0).T_map_axle;
  const Pose2 end = plan.state_at(plan.duration_s()).T_map_axle;
  RC_ASSERT((start.translation() - waypoints.front().position_m).norm() < 1e-9);
  RC_ASSERT((end.translation() - waypoints.back().position_m).norm() < 1e-9);
}

}  // namespace
}  // namespace gdtslam::sim

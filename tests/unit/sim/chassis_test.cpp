// The body in space: on a ramp and over a sill against closed forms, its sway, and the travel of the wheels.
#include "engine/sim/chassis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::sim {
namespace {

using testing::ElementsAre;

MotionState at(const Pose2& T_map_axle, double path_m = 0.0) {
  MotionState state;
  state.T_map_axle = T_map_axle;
  state.path_m = path_m;
  return state;
}

// Rises by 0.1 m a metre along x, from x = 0.
SimulationConfig on_ramp() {
  SimulationConfig config;
  config.laser = *laser_preset("sick-lms");
  config.floor_parts = {make_ramp({0.0, 0.0, 0.0}, {10.0, 0.0, 1.0}, 8.0)};
  return config;
}

TEST(Chassis, OnEvenFloorThePoseIsThatOfThePlan) {
  SimulationConfig config;
  config.floor_m = 0.25;
  const Chassis chassis(config);
  EXPECT_TRUE(chassis.is_level());
  EXPECT_EQ(chassis.T_map_base(at({1.0, 2.0, 3.0})), embed({1.0, 2.0, 3.0}, 0.25));
}

TEST(Chassis, OnARampItsAxesLieInTheRampForEveryHeading) {
  const SimulationConfig config = on_ramp();
  const Chassis chassis(config);
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.1, 0.0, 1.0).normalized();
  for (double heading_deg = -180.0; heading_deg < 180.0; heading_deg += 15.0) {
    const Pose2 plan{5.0, 1.0, rad_from_deg(heading_deg)};
    const Pose3 T = chassis.T_map_base(at(plan));
    EXPECT_NEAR((T.translation_m - Point3(5.0, 1.0, 0.5)).norm(), 0.0, 1e-12);
    const Eigen::Matrix3d R = rotation_matrix(T.rotation);
    EXPECT_NEAR((R.col(2) - normal).norm(), 0.0, 1e-12) << heading_deg;
    EXPECT_NEAR(wrap_angle(project(T).theta_rad - plan.theta_rad), 0.0, 1e-12) << heading_deg;
  }
}

TEST(Chassis, OverASillTheBodyIsThePlaneOfItsFourWheels) {
  SimulationConfig config;
  config.chassis.wheelbase_m = 0.5;
  config.floor_parts = {make_sill({2.0, -1.0}, {2.0, 1.0}, 0.1, 0.02, 0.0)};
  const Chassis chassis(config);
  // The front wheels stand on the sill.
  const Pose3 front = chassis.T_map_base(at({1.75, 0.0, 0.0}));
  EXPECT_NEAR(front.translation_m.z(), 0.01, 1e-12);
  EXPECT_NEAR((log_so3(front.rotation) - Eigen::Vector3d(0.0, -std::atan(0.02 / 0.5), 0.0)).norm(), 0.0, 1e-12);
  // Both left ones do: the robot drives along the sill, half a track beside it.
  const Pose3 side = chassis.T_map_base(at({2.2, 0.0, 0.5 * kPi}));
  EXPECT_NEAR(side.translation_m.z(), 0.01, 1e-12);
  const Eigen::Vector3d left = rotation_matrix(side.rotation).col(1);
  EXPECT_NEAR(std::atan2(left.z(), left.head<2>().norm()), std::atan(0.02 / config.wheels.true_track_width_m()), 1e-12);
}

struct Spread {
  double mean = 0.0;
  double deviation = 0.0;
};

Spread spread_of(const std::vector<double>& values) {
  Spread spread;
  for (const double value : values) spread.mean += value / static_cast<double>(values.size());
  for (const double value : values) spread.deviation += std::pow(value - spread.mean, 2.0);
  spread.deviation = std::sqrt(spread.deviation / static_cast<double>(values.size()));
  return spread;
}

TEST(Chassis, SwayHasTheStatedDeviationsAndIsSmooth) {
  SimulationConfig config;
  config.chassis.sway_tilt_rad = rad_from_deg(0.4);
  config.chassis.sway_heave_m = 0.01;
  const Chassis chassis(config);
  std::vector<double> rolls;
  std::vector<double> pitches;
  std::vector<double> heaves;
  double most_change_rad = 0.0;
  for (double path_m = 0.0; path_m < 3000.0; path_m += 0.05) {
    const Pose3 T = chassis.T_map_base(at({}, path_m));
    const Eigen::Vector3d turn = log_so3(T.rotation);
    if (!rolls.empty()) most_change_rad = std::max(most_change_rad, std::fabs(turn.x() - rolls.back()));
    rolls.push_back(turn.x());
    pitches.push_back(turn.y());
    heaves.push_back(T.translation_m.z());
  }
  EXPECT_NEAR(spread_of(rolls).deviation, rad_from_deg(0.4), rad_from_deg(0.01));
  EXPECT_NEAR(spread_of(pitches).deviation, rad_from_deg(0.4), rad_from_deg(0.01));
  EXPECT_NEAR(spread_of(heaves).deviation, 0.01, 0.00025);
  for (const auto& values : {rolls, pitches, heaves}) {
    EXPECT_NEAR(spread_of(values).mean, 0.0, 0.02 * spread_of(values).deviation);
  }
  // Eight waves of 3 to 12 m, each at most half the deviation.
  EXPECT_LT(most_change_rad, 0.05 * kTwoPi / 3.0 * 4.0 * rad_from_deg(0.4));
  // Roll and pitch are not the same curve, and another seed gives others.
  EXPECT_NE(rolls[100], pitches[100]);
  config.seed = 2;
  EXPECT_NE(log_so3(Chassis(config).T_map_base(at({}, 5.0)).rotation).x(), rolls[100]);
}

// What the odometry makes of a drive straight ahead, at one scan a second.
double odometry_m(const SimulationConfig& config, double from_x_m, double to_x_m, double odometry_rate_hz) {
  std::vector<Waypoint> path(2);
  path[0].position_m = {from_x_m, 0.0};
  path[1].position_m = {to_x_m, 0.0};
  path[1].pause_s = 2.0;
  Scene scene;
  scene.floor_m = 0.0;
  scene.floor_parts = config.floor_parts;
  SimulationConfig exact = config;
  exact.wheels.ticks_per_m = 1e8;
  exact.scan_rate_hz = 1.0;
  exact.odometry_rate_hz = odometry_rate_hz;
  double ahead_m = 0.0;
  SimulationSink sink;
  sink.scan = [](const SimulatedScan&) {};
  sink.odometry = [&](const Odometry& odometry) { ahead_m = odometry.T_odom_base.x_m; };
  sink.keep_on = [](double) { return true; };
  run_simulation(exact, MotionPlan(path, {}), RayCaster(triangulate(scene)), sink);
  return ahead_m;
}

TEST(Chassis, WheelsCountTheWayAlongTheSlope) {
  const SimulationConfig config = on_ramp();
  for (const double rate_hz : {1.0, 50.0}) {
    EXPECT_NEAR(odometry_m(config, 1.0, 9.0, rate_hz), 8.0 * std::sqrt(1.01), 1e-6);
    EXPECT_NEAR(odometry_m(config, 9.0, 1.0, rate_hz), 8.0 * std::sqrt(1.01), 1e-6);
  }
  // A sill of eight pieces: the length of its profile.
  SimulationConfig sill = config;
  sill.floor_parts = {make_sill({2.0, -1.0}, {2.0, 1.0}, 0.1, 0.015, 0.0)};
  double over_m = 0.0;
  const std::vector<Point2>& profile = sill.floor_parts[0].profile_m;
  for (std::size_t k = 1; k < profile.size(); ++k) over_m += (profile[k] - profile[k - 1]).norm();
  EXPECT_NEAR(odometry_m(sill, 1.0, 3.0, 50.0), 1.9 + over_m, 1e-4);
  EXPECT_GT(over_m, 0.105);
}

TEST(Chassis, RefusesValuesBeyondItsLimits) {
  SimulationConfig config = on_ramp();
  config.chassis = {.wheelbase_m = 0.0, .sway_tilt_rad = 1.0, .sway_heave_m = -1.0, .sway_wavelength_m = std::nan("")};
  EXPECT_THAT(validate(config),
              ElementsAre("chassis: wheelbase must be 1 cm to 100 m", "chassis: sway_tilt must be 0 to 10 deg",
                          "chassis: sway_heave must be 0 to 1 m", "chassis: sway_wavelength must be 10 cm to 1000 m"));
}

}  // namespace
}  // namespace gdtslam::sim

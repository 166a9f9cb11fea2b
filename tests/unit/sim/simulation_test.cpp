// A whole drive: what is recorded when, what the truth is, and what a seed moves.
#include "gdtslam/sim/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

struct Log {
  std::vector<SimulatedScan> scans;
  std::vector<Odometry> odometry;
  std::vector<double> stamps_s;  // of all records in order
  std::string kinds;             // S for a scan, o for odometry
  SimulationSummary summary;
};

RayCaster room() {
  Scene scene;
  scene.boxes.push_back({{4.0, 3.0}, {12.0, 10.0}, 0.0, 0.0, 2.5});
  scene.cylinders.push_back({{2.0, 5.0}, 0.3, 0.0, 2.5, 32});
  return RayCaster(triangulate(scene));
}

// A robot that stands.
MotionPlan pause_of(double pause_s) {
  std::vector<Waypoint> waypoints(1);
  waypoints[0].pause_s = pause_s;
  return {waypoints, {}};
}

MotionPlan loop() {
  std::vector<Waypoint> waypoints(5);
  waypoints[1].position_m = {6.0, 0.0};
  waypoints[2].position_m = {6.0, 4.0};
  waypoints[3].position_m = {0.0, 4.0};
  waypoints[4].position_m = {0.0, 0.5};
  return {waypoints, {}};
}

SimulationConfig config_of(double scan_rate_hz, double odometry_rate_hz) {
  SimulationConfig config;
  config.laser = *laser_preset("sick-lms");
  config.laser.drop_out_share = 0.01;
  config.T_base_laser = {0.2, 0.0, 0.0};
  config.wheels.slip_m_per_sqrt_m = 0.01;
  config.scan_rate_hz = scan_rate_hz;
  config.odometry_rate_hz = odometry_rate_hz;
  return config;
}

Log record(const SimulationConfig& config, std::size_t most_scans = 100'000, const MotionPlan& plan = loop()) {
  Log log;
  SimulationSink sink;
  sink.scan = [&](const SimulatedScan& scan) {
    log.scans.push_back(scan);
    log.kinds += 'S';
    log.stamps_s.push_back(scan.record.scan.stamp_s);
  };
  sink.odometry = [&](const Odometry& odometry) {
    log.odometry.push_back(odometry);
    log.kinds += 'o';
    log.stamps_s.push_back(odometry.stamp_s);
  };
  sink.keep_on = [&](double) { return log.scans.size() < most_scans; };
  log.summary = run_simulation(config, plan, room(), sink);
  return log;
}

TEST(Simulation, RecordsComeInTheOrderOfTheirTime) {
  const Log log = record(config_of(8.0, 10.0));
  const double duration_s = loop().duration_s();
  EXPECT_EQ(log.scans.size(), static_cast<std::size_t>(std::floor(duration_s * 8.0)) + 1);
  EXPECT_EQ(log.odometry.size(), static_cast<std::size_t>(std::floor(duration_s * 10.0)) + 1);
  EXPECT_EQ(log.summary.scans, log.scans.size());
  EXPECT_TRUE(std::is_sorted(log.stamps_s.begin(), log.stamps_s.end()));
  EXPECT_EQ(log.scans[3].record.scan.stamp_s, 0.375);
  EXPECT_EQ(record(config_of(8.0, 0.0)).odometry.size(), 0U);
  // Odometry comes first where both have the same time.
  EXPECT_EQ(record(config_of(5.0, 10.0)).kinds.substr(0, 9), "oSooSooSo");
}

TEST(Simulation, WithoutErrorsOdometryAndTruthAgree) {
  SimulationConfig config = config_of(10.0, 20.0);
  config.wheels.slip_m_per_sqrt_m = 0.0;
  config.wheels.ticks_per_m = 1e6;
  config.wheels.drive.centre_ahead_of_axle_m = 0.15;
  const Log log = record(config);
  const Pose2 T_map_odom = project(log.scans.front().T_map_base);
  for (const SimulatedScan& scan : log.scans) {
    const Pose2 error = between(project(scan.T_map_base), T_map_odom * *scan.record.T_odom_base);
    // The chord of a 0.05 s arc differs from the smooth turn's by less than 1e-4 m over the loop.
    EXPECT_LT(error.translation().norm(), 1e-3);
    EXPECT_LT(std::fabs(error.theta_rad), 1e-4);
  }
}

bool has_equal_scans(const Log& a, const Log& b) {
  return std::equal(
      a.scans.begin(), a.scans.end(), b.scans.begin(), b.scans.end(),
      [](const SimulatedScan& x, const SimulatedScan& y) { return x.record.scan.ranges_m == y.record.scan.ranges_m; });
}

bool has_equal_odometry(const Log& a, const Log& b) {
  return std::equal(
      a.scans.begin(), a.scans.end(), b.scans.begin(), b.scans.end(),
      [](const SimulatedScan& x, const SimulatedScan& y) { return x.record.T_odom_base == y.record.T_odom_base; });
}

TEST(Simulation, ASeedFixesEverythingAndMovesEverything) {
  SimulationConfig config = config_of(5.0, 10.0);
  const Log first = record(config);
  const Log again = record(config);
  EXPECT_TRUE(has_equal_scans(first, again));
  EXPECT_TRUE(has_equal_odometry(first, again));
  config.seed = 2;
  const Log other = record(config);
  EXPECT_FALSE(has_equal_scans(first, other));
  EXPECT_FALSE(has_equal_odometry(first, other));
}

TEST(Simulation, OneErrorsDrawsDoNotMoveTheOthers) {
  SimulationConfig config = config_of(5.0, 10.0);
  const Log first = record(config);
  config.wheels.slip_m_per_sqrt_m = 0.05;
  const Log more_slip = record(config);
  EXPECT_TRUE(has_equal_scans(first, more_slip));
  EXPECT_FALSE(has_equal_odometry(first, more_slip));
  config = config_of(5.0, 10.0);
  config.laser = *laser_preset("hokuyo-961");
  EXPECT_TRUE(has_equal_odometry(first, record(config)));
}

// 10,000 s at 9,999 and 1 Hz are 100,000,000 records.
TEST(Simulation, HasAHundredMillionRecordsAtMost) {
  EXPECT_EQ(record(config_of(9'999.0, 1.0), 3, pause_of(10'000.0)).scans.size(), 3U);
  try {
    record(config_of(9'999.0, 1.0), 3, pause_of(10'000.5));
    FAIL() << "simulated more";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("has 100005000 records at these rates"), std::string::npos);
  }
}

}  // namespace
}  // namespace gdtslam::sim

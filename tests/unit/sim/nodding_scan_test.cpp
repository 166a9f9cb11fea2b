// What a nodding laser measures, against theory: ranges to walls, floor and ceiling, and what the truth says about
// them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/sim/simulation.hpp"

namespace gdtslam::sim {
namespace {

struct NoddingLog {
  std::vector<SimulatedScan> scans;
  std::vector<Encoder> messages;
  std::vector<std::vector<double>> elevations_rad;  // of each beam of each scan
  SimulationSummary summary;
};

// A tall wall whose face is at x = 3, a floor at 0, a ceiling at 30 m.
RayCaster hall() {
  Scene scene;
  scene.boxes.push_back({{3.5, 0.0}, {1.0, 60.0}, 0.0, -1.0, 40.0});
  scene.boxes.push_back({{-40.0, 0.0}, {1.0, 60.0}, 0.0, 0.0, 30.0});
  scene.floor_m = 0.0;
  scene.ceiling_m = 30.0;
  return RayCaster(triangulate(scene));
}

MotionPlan standing(double duration_s) {
  std::vector<Waypoint> one(1);
  one[0].pause_s = duration_s;
  return {one, {}};
}

SimulationConfig exact_config() {
  SimulationConfig config;
  config.laser = *laser_preset("hokuyo-961");
  config.laser.noise_constant_m = 0.0;
  config.laser.range_resolution_m = 0.0;
  config.laser.drop_out_share = 0.0;
  config.laser.max_range_m = 60.0;
  config.scan_rate_hz = 20.0;
  config.laser_height_m = 0.4;
  config.nodding.emplace().truth = calib::sweep_model_of_preset("paper-b");
  match_laser(config);
  return config;
}

NoddingLog record(const SimulationConfig& config, const MotionPlan& plan, const RayCaster& caster) {
  NoddingLog log;
  SimulationSink sink;
  sink.scan = [&](const SimulatedScan& scan) {
    std::vector<double> elevations;
    elevations.reserve(scan.beams.size());
    for (const BeamTruth& beam : scan.beams) {
      elevations.push_back(scan.course->elevation_rad(scan.record.scan.stamp_s + beam.offset_s));
    }
    log.elevations_rad.push_back(std::move(elevations));
    log.scans.push_back(scan);
  };
  sink.odometry = [](const Odometry&) {};
  sink.encoder = [&](const Encoder& message) { log.messages.push_back(message); };
  sink.keep_on = [](double) { return true; };
  log.summary = run_simulation(config, plan, caster, sink);
  return log;
}

double bearing_of(std::size_t beam) { return rad_from_deg(-120.0 + 0.25 * static_cast<double>(beam)); }

TEST(NoddingScan, StandingItSeesWallFloorAndCeilingWhereTheoryPutsThem) {
  const SimulationConfig config = exact_config();
  const NoddingLog log = record(config, standing(7.0), hall());
  ASSERT_GT(log.scans.size(), 100U);
  std::size_t walls = 0;
  std::size_t floors = 0;
  std::size_t ceilings = 0;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    for (std::size_t k = 0; k < 961; k += 7) {
      const double range = static_cast<double>(log.scans[i].record.scan.ranges_m[k]);
      const double e = log.elevations_rad[i][k];
      // Equation (12): the beam's part along x and z for a length of 1.
      const double ahead = std::cos(bearing_of(k)) * std::cos(e);
      const double up = std::cos(bearing_of(k)) * std::sin(e);
      const double by_wall = ahead > 0.0 ? 3.0 / ahead : HUGE_VAL;
      const double by_floor = up < 0.0 ? 0.4 / -up : HUGE_VAL;
      const double by_ceiling = up > 0.0 ? (30.0 - 0.4) / up : HUGE_VAL;
      const double nearest = std::min({by_wall, by_floor, by_ceiling});
      if (!(nearest < 29.9) || std::fabs(nearest * std::sin(bearing_of(k))) > 29.0) {
        continue;  // beyond the wall's ends
      }
      EXPECT_NEAR(range, nearest, 2e-6 * nearest) << "scan " << i << " beam " << k;
      walls += nearest == by_wall ? 1U : 0U;
      floors += nearest == by_floor ? 1U : 0U;
      ceilings += nearest == by_ceiling ? 1U : 0U;
    }
  }
  EXPECT_GT(walls, 3000U);
  EXPECT_GT(floors, 3000U);
  EXPECT_GT(ceilings, 50U);
}

TEST(NoddingScan, ALeverArmMovesTheForwardBeamAsTheoryHasIt) {
  SimulationConfig config = exact_config();
  config.laser.first_bearing_rad = 0.0;
  config.laser.beam_count = 1;
  const double a = 0.07;
  const double b = 0.03;
  config.nodding->truth.mount.lever_forward_m = a;
  config.nodding->truth.mount.lever_up_m = b;
  const NoddingLog log = record(config, standing(7.0), hall());
  std::size_t checked = 0;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const double e = log.elevations_rad[i][0];
    if (e > rad_from_deg(80.0)) {
      continue;
    }
    // docs/paper.md, (A1) with a lever arm; the axis lies `a` behind the laser at level, so the wall is 3 + a from it.
    const double range = (3.0 + a - a * std::cos(e) + b * std::sin(e)) / std::cos(e);
    EXPECT_NEAR(static_cast<double>(log.scans[i].record.scan.ranges_m[0]), range, 2e-6 * range) << i;
    ++checked;
  }
  EXPECT_GT(checked, 60U);
}

// The distance of a point from a triangle's plane, and whether it lies within, by barycentric coordinates.
bool is_on(const std::array<Vec3, 3>& t, const Vec3& p) {
  const Vec3 u = t[1] - t[0];
  const Vec3 v = t[2] - t[0];
  const Vec3 n = u.cross(v);
  const Vec3 w = p - t[0];
  const double beta = n.dot(u.cross(w)) / n.dot(n);
  const double gamma = n.dot(w.cross(v)) / n.dot(n);
  constexpr double kEdge = 1e-9;
  return std::fabs(n.dot(w)) / n.norm() < 1e-9 && beta > -kEdge && gamma > -kEdge && beta + gamma < 1.0 + kEdge;
}

MotionPlan drive() {
  std::vector<Waypoint> path(2);
  path[0].position_m = {-30.0, -1.0};
  path[1].position_m = {-1.0, 1.0};
  MotionLimits limits;
  limits.speed_m_per_s = 2.0;
  return {path, limits};
}

TEST(NoddingScan, TrueHitsLieOnTheSceneWhereTheBeamAtItsOwnTimePoints) {
  const SimulationConfig config = exact_config();
  const RayCaster caster = hall();
  const MotionPlan plan = drive();
  const NoddingLog log = record(config, plan, caster);
  std::size_t hits = 0;
  double most_within_scan_m = 0.0;
  for (std::size_t i = 0; i < log.scans.size(); i += 9) {
    const SimulatedScan& scan = log.scans[i];
    for (std::size_t k = 0; k < 961; k += 31) {
      const BeamTruth& beam = scan.beams[k];
      if (std::isinf(beam.range_m)) {
        continue;
      }
      ++hits;
      EXPECT_TRUE(is_on(caster.mesh().corners(beam.triangle), beam.hit_m)) << i << " " << k;
      // Beam k fires (k - 480) * 0.25 deg of a mirror of 40 Hz after the stamp.
      const double offset_s = (static_cast<double>(k) - 480.0) * 0.25 / 360.0 / 40.0;
      EXPECT_NEAR(beam.offset_s, offset_s, 1e-12);
      const Pose2 at = plan.state_at(scan.record.scan.stamp_s + offset_s).T_map_axle;
      const double e = log.elevations_rad[i][k];
      const double x = beam.range_m * std::cos(bearing_of(k)) * std::cos(e);
      const double y = beam.range_m * std::sin(bearing_of(k));
      const double z = 0.4 + beam.range_m * std::cos(bearing_of(k)) * std::sin(e);
      EXPECT_NEAR(beam.hit_m.x(), at.x_m + x * std::cos(at.theta_rad) - y * std::sin(at.theta_rad), 1e-9);
      EXPECT_NEAR(beam.hit_m.y(), at.y_m + x * std::sin(at.theta_rad) + y * std::cos(at.theta_rad), 1e-9);
      EXPECT_NEAR(beam.hit_m.z(), z, 1e-9);
      most_within_scan_m = std::max(most_within_scan_m, std::fabs(at.x_m - scan.T_map_base.translation_m.x()));
    }
  }
  EXPECT_GT(hits, 500U);
  // At 2 m/s the robot moves 16.7 mm from a scan's middle to its last beam.
  EXPECT_NEAR(most_within_scan_m, 2.0 * 480.0 * 0.25 / 360.0 / 40.0, 1e-3);
}

TEST(NoddingScan, TheEncoderCoversEveryBeam) {
  const SimulationConfig config = exact_config();
  for (const double duration_s : {1.0, 2.003, 2.0168, 3.3333}) {
    // With 2.0168 s the last beam fires at 2.01667 s, after the last message before the end.
    const NoddingLog log = record(config, standing(duration_s), hall());
    ASSERT_FALSE(log.scans.empty());
    EXPECT_EQ(log.messages.size(), log.summary.encoder_records);
    EXPECT_LE(log.messages.front().stamp_s,
              log.scans.front().record.scan.stamp_s + log.scans.front().beams.front().offset_s);
    EXPECT_GE(log.messages.back().stamp_s,
              log.scans.back().record.scan.stamp_s + log.scans.back().beams.back().offset_s);
    for (std::size_t i = 1; i < log.messages.size(); ++i) {
      EXPECT_NEAR(log.messages[i].stamp_s - log.messages[i - 1].stamp_s, 0.01, 1e-9);
    }
  }
}

}  // namespace
}  // namespace gdtslam::sim

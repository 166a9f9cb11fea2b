// Drives over ramps and sills with a body that sways: the truth in space and the true elevations put the beams on the
// scene's surfaces, and the plan's truth or the linkage's elevations do not.
#if __has_include("gdtslam/sim/scene.hpp")  // the simulator may be left out of a build

#include <cmath>
#include <sstream>

#include "engine/runs/folder/linkage_file.hpp"
#include "engine/sim/surface_distance.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/nodding.hpp"
#include "simulate_nodding_fixture.hpp"
#include "tools/gdtslam/scenes/scene_file.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

// The mirror has no speed, so that every beam is measured at the scan's stamp.
constexpr const char* kRampScene = R"(gdtslam_scene: 1
walls:
  - {points: [[-1, -2], [9, -2], [9, 2], [-1, 2]], closed: true, height: 3}
floor: 0
ceiling: 2.9
ramps: [{from: [1, 0, 0], to: [5, 0, 0.21], width: 4}]
plates: [{centre: [7, 0], size: [4, 4], height: 0.21}]
sills: [{from: [6, -1], to: [6, 1], base: 0.21}]
robot:
  chassis: {sway_tilt: 0.4 deg, sway_heave: 1 cm}
  laser: {preset: hokuyo-961, beams: 241, bearing_step: 1 deg, mirror_rate: 0, drop_outs: 0, mount: {x: 10 cm}}
  nodding: {crank_rate: 0.3, elevation_error: 0.5 deg, lever: {forward: 3 cm, up: 2 cm}}
recording: {scan_rate: 10, odometry_rate: 10}
waypoints: [[0, 0], [7, 0.4], [7.4, -0.6]]
)";

class SimulateSpaceTest : public SimulateNoddingTest {
 protected:
  struct Truth {
    std::vector<Pose3> poses;
    std::vector<double> elevations_rad;
  };

  [[nodiscard]] Truth truth() const {
    Truth truth;
    std::istringstream rows(content_of(path("a.truth.tum")));
    double stamp_s = 0.0;
    Pose3 pose;
    Eigen::Vector4d q;
    while (rows >> stamp_s >> pose.translation_m[0] >> pose.translation_m[1] >> pose.translation_m[2] >> q[0] >> q[1] >>
           q[2] >> q[3]) {
      pose.rotation = Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
      truth.poses.push_back(pose);
    }
    std::istringstream lines(content_of(path("a.elevation.csv")));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      truth.elevations_rad.push_back(std::stod(line.substr(line.rfind(',') + 1)));
    }
    return truth;
  }

  // Mean distance from the surfaces of the points that the log's ranges give.
  [[nodiscard]] double mean_distance_m(const Truth& truth) const {
    const sim::SurfaceDistance surfaces(triangulate(read_scene(path("ramp.yaml")).scene));
    const calib::SweepModel linkage = read_linkage(path("a.linkage.yaml"));
    const std::vector<LaserScan> measured = scans("a.log");
    EXPECT_EQ(measured.size(), truth.poses.size());
    EXPECT_EQ(measured.size(), truth.elevations_rad.size());
    double sum_m = 0.0;
    std::size_t points = 0;
    for (std::size_t i = 0; i < measured.size(); ++i) {
      const LaserScan& scan = measured[i];
      const Pose3 T_map_laser =
          truth.poses[i] * T_base_laser(linkage.mount, scan.T_base_laser, truth.elevations_rad[i]);
      for (std::size_t k = 0; k < scan.ranges_m.size(); k += 5) {
        const auto range_m = static_cast<double>(scan.ranges_m[k]);
        if (range_m >= scan.max_range_m) continue;
        const double bearing = scan.first_bearing_rad + static_cast<double>(k) * scan.bearing_step_rad;
        const Point3 beam(range_m * std::cos(bearing), range_m * std::sin(bearing), 0.0);
        sum_m += surfaces.nearest(T_map_laser * beam).distance_m;
        ++points;
      }
    }
    EXPECT_GT(points, 5'000U);
    return sum_m / static_cast<double>(points);
  }

  // The elevations that a reader of log and linkage has.
  [[nodiscard]] std::vector<double> nominal_elevations_rad() const {
    const calib::SweepModel linkage = read_linkage(path("a.linkage.yaml"));
    std::vector<double> elevations_rad;
    std::istringstream lines(content_of(path("a.elevation.csv")));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      const std::size_t turns_at = line.find(',', line.find(',') + 1) + 1;
      const double ticks = std::stod(line.substr(turns_at)) * static_cast<double>(linkage.encoder.ticks_per_turn);
      elevations_rad.push_back(calib::elevation_rad(linkage, calib::crank_rad(linkage.encoder, ticks)).value());
    }
    return elevations_rad;
  }

  [[nodiscard]] std::string refusal(const std::string& scene) const {
    write("refused.yaml", scene);
    try {
      simulate(options("refused.log", "refused.yaml"));
    } catch (const ConfigError& error) {
      return std::string(error.what()).substr(path("refused.yaml").size());
    }
    return "accepted";
  }
};

TEST_F(SimulateSpaceTest, TruthInSpaceAndTrueElevationsPutTheBeamsOnTheSurfaces) {
  write("ramp.yaml", kRampScene);
  SimulateOptions chosen = options("a.log", "ramp.yaml");
  chosen.is_exact = true;
  simulate(chosen);
  const Truth exact = truth();
  EXPECT_LT(mean_distance_m(exact), 1e-6);
  Truth flat = exact;
  for (Pose3& pose : flat.poses) pose = embed(project(pose));
  EXPECT_GT(mean_distance_m(flat), 0.03);
  Truth nominal = exact;
  nominal.elevations_rad = nominal_elevations_rad();
  EXPECT_GT(mean_distance_m(nominal), 2e-3);
  EXPECT_LT(mean_distance_m(nominal), 3e-2);
  double sq_sum = 0.0;
  for (std::size_t i = 0; i < exact.elevations_rad.size(); ++i) {
    sq_sum += std::pow(exact.elevations_rad[i] - nominal.elevations_rad[i], 2.0);
  }
  const double rms_rad = std::sqrt(sq_sum / static_cast<double>(exact.elevations_rad.size()));
  EXPECT_NEAR(rms_rad, rad_from_deg(0.5), rad_from_deg(0.1));
  // The drive ends on the plate.
  EXPECT_NEAR(exact.poses.back().translation_m.z(), 0.21, 0.03);

  chosen.is_exact = false;
  simulate(chosen);
  // Noise of 1 cm along the beam: at most 8 mm on average, and less at a slant.
  EXPECT_GT(mean_distance_m(truth()), 2e-3);
  EXPECT_LT(mean_distance_m(truth()), 8e-3);
}

TEST_F(SimulateSpaceTest, OptionsReplaceTheScenesSwayAndElevationError) {
  write("ramp.yaml", kRampScene);
  SimulateOptions chosen = options("a.log", "ramp.yaml");
  chosen.sway_tilt_rad = 0.0;
  chosen.sway_heave_m = 0.0;
  chosen.elevation_error_rad = 0.0;
  simulate(chosen);
  const Pose3 first = truth().poses.front();
  EXPECT_EQ(first.translation_m.z(), 0.0);
  EXPECT_EQ(first.rotation.vec().head<2>(), Eigen::Vector2d::Zero());
  const std::vector<double> nominal = nominal_elevations_rad();
  for (std::size_t i = 0; i < nominal.size(); ++i) EXPECT_NEAR(truth().elevations_rad.at(i), nominal[i], 1e-9);
  chosen.sway_tilt_rad = 1.0;
  EXPECT_THROW(simulate(chosen), UsageError);
}

TEST_F(SimulateSpaceTest, RefusesAPathOverAnEdge) {
  const std::string walls = "gdtslam_scene: 1\nwalls: [{points: [[-5, -5], [9, -5]]}]\nfloor: 0\n";
  EXPECT_THAT(refusal(walls + "plates: [{centre: [4, 0], size: [2, 2], height: 0.2}]\nwaypoints: [[0, 0], [4, 0]]\n"),
              HasSubstr(": the floor below a wheel steps by 0.200 m near (2.8"));
  EXPECT_EQ(refusal(walls + "ramps: [{from: [1, 0, 0], to: [3, 0, 0.2], width: 2}]\n"
                            "plates: [{centre: [4, 0], size: [2, 2], height: 0.2}]\nwaypoints: [[0, 0], [4, 0]]\n"),
            "accepted");
  EXPECT_EQ(refusal("gdtslam_scene: 1\nfloor: 0\nramps: [{from: [1, 0, 0], to: [9, 0, 0.2], width: 2}]\n"
                    "waypoints: [[0, 0], [4, 0]]\n"),
            "accepted");
  EXPECT_THAT(refusal(walls + "ramps: [{from: [1, 0, 0], to: [3, 0, 0.2], width: 2}]\nwaypoints: [[2, -3], [2, 0]]\n"),
              HasSubstr("add a ramp, make it wider or flatter, or move the waypoints there"));
}

}  // namespace
}  // namespace gdtslam

#endif

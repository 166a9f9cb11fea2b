#include "simulate_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "carmen_writer.hpp"
#include "did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/atomic_file.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/sim/clearance.hpp"
#include "gzip_file.hpp"
#include "scene_file.hpp"

namespace gdtslam {
namespace {

constexpr double kClearanceLimit_m = 2.0;
// What lies on the floor to this height is driven over.
constexpr double kGroundClearance_m = 0.02;

std::string without_ending(std::string name, std::string_view ending) {
  if (name.ends_with(ending) && name.size() > ending.size()) {
    name.resize(name.size() - ending.size());
  }
  return name;
}

std::string truth_file_of(const std::string& log_file) {
  return without_ending(without_ending(without_ending(log_file, ".gz"), ".log"), ".clf") + ".truth.tum";
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void apply_options(const SimulateOptions& options, SceneFile& scene) {
  if (options.laser) {
    const std::optional<sim::LaserModel> laser = sim::laser_preset(*options.laser);
    if (!laser) {
      throw UsageError("unknown laser '" + *options.laser + "'" +
                       did_you_mean(*options.laser, sim::laser_preset_names()) + "; there are " +
                       joined(sim::laser_preset_names()));
    }
    scene.laser = *options.laser;
    scene.config.laser = *laser;
  }
  if (options.scan_rate_hz) {
    scene.config.scan_rate_hz = *options.scan_rate_hz;
    if (const std::vector<std::string> faults = validate(scene.config); !faults.empty()) {
      throw UsageError("--rate: " + faults.front());
    }
  }
  if (options.trajectory) {
    scene.waypoints = read_waypoints(*options.trajectory);
  }
  scene.config.seed = options.seed;
  if (const std::vector<std::string> faults = validate(scene.config); !faults.empty()) {
    throw UsageError(faults.front());
  }
}

sim::MotionPlan plan_of(const SceneFile& scene, const std::string& source) {
  if (scene.waypoints.empty()) {
    throw ConfigError({source, 0}, "has no waypoints: add them, or give --trajectory FILE");
  }
  try {
    return {scene.waypoints, scene.limits};
  } catch (const ConfigError& error) {
    throw ConfigError({source, 0}, error.what());
  }
}

// Places of the robot's centre along its path, about 5 cm apart.
std::vector<Point2> places_along(const SceneFile& scene, const sim::MotionPlan& plan) {
  constexpr double kStep_m = 0.05;
  constexpr double kMostPlaces = 2e6;
  const double wanted = plan.duration_s() * scene.limits.speed_m_per_s / kStep_m;
  const auto count = static_cast<std::size_t>(std::clamp(wanted, 2.0, kMostPlaces));
  std::vector<Point2> places_m;
  places_m.reserve(count + 1);
  for (std::size_t i = 0; i <= count; ++i) {
    const double time_s = plan.duration_s() * static_cast<double>(i) / static_cast<double>(count);
    places_m.push_back(base_pose(scene.config.wheels, plan.state_at(time_s)).translation());
  }
  return places_m;
}

// The smallest clearance of the path. Throws ConfigError where the robot would touch something.
double checked_clearance_m(const SceneFile& scene, const sim::MotionPlan& plan, const sim::TriangleMesh& mesh,
                           const std::string& source) {
  const double floor_m = scene.scene.floor_m.value_or(0.0);
  const std::vector<Point2> places_m = places_along(scene, plan);
  const std::vector<double> clearances_m = sim::clearances_m(
      mesh, {floor_m + kGroundClearance_m, floor_m + scene.body.height_m, kClearanceLimit_m}, places_m);
  const auto nearest = std::min_element(clearances_m.begin(), clearances_m.end());
  if (*nearest < scene.body.radius_m) {
    const Point2& place_m = places_m[static_cast<std::size_t>(nearest - clearances_m.begin())];
    throw ConfigError({source, 0}, "the path comes within " + fixed_text(*nearest, 3) + " m of an obstacle at (" +
                                       fixed_text(place_m.x(), 2) + ", " + fixed_text(place_m.y(), 2) +
                                       "), but the robot's radius is " + fixed_text(scene.body.radius_m, 3) +
                                       " m: move the waypoints there");
  }
  return *nearest;
}

int range_decimals(const sim::LaserModel& laser) {
  // A range that is not rounded by the sensor is kept to the micrometre; whole centimetres still get three decimals.
  constexpr double kMillimetre_m = 0.001;
  return laser.range_resolution_m >= kMillimetre_m ? 3 : 6;
}

std::string one_word(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c <= ' ' || c > '~'; }, '-');
  return text.empty() ? "-" : text;
}

// What the log was made of, so that it can be made again.
std::string header_of(const SceneFile& scene, const CarmenWriter& writer) {
  const sim::SimulationConfig& config = scene.config;
  const std::vector<std::pair<std::string, std::string>> parameters{
      {"simulated_scene", one_word(scene.name)},
      {"simulated_seed", std::to_string(config.seed)},
      {"simulated_laser", scene.laser},
      {"simulated_laser_noise", fixed_text(config.laser.noise_constant_m, 6)},
      {"simulated_laser_noise_share", fixed_text(config.laser.noise_share, 6)},
      {"simulated_laser_drop_outs", fixed_text(config.laser.drop_out_share, 6)},
      {"simulated_laser_height", fixed_text(config.laser_height_m, 6)},
      {"simulated_wheel_slip", fixed_text(config.wheels.slip_m_per_sqrt_m, 6)},
      {"simulated_wheel_left_scale", fixed_text(config.wheels.left_scale, 6)},
      {"simulated_wheel_right_scale", fixed_text(config.wheels.right_scale, 6)},
      {"simulated_track_width", fixed_text(config.wheels.drive.track_width_m, 6)},
      {"simulated_track_width_scale", fixed_text(config.wheels.track_width_scale, 6)},
      {"robot_frontlaser_offset", fixed_text(config.T_base_laser.x_m, 6)},
      {"robot_front_laser_max", fixed_text(config.laser.max_range_m, 6)},
  };
  std::string header;
  for (const auto& [name, value] : parameters) {
    header += writer.parameter(name, value);
  }
  return header;
}

struct Recording {
  sim::SimulationSummary summary;
  Trajectory truth;
};

Recording record(const SimulateOptions& options, const SceneFile& scene, const sim::MotionPlan& plan,
                 const sim::RayCaster& caster, TextSink& log) {
  Recording recording;
  CarmenWriter writer(range_decimals(scene.config.laser));
  log.write(header_of(scene, writer));
  sim::SimulationSink sink;
  sink.odometry = [&](const Odometry& odometry) { log.write(writer.odometry(odometry)); };
  sink.scan = [&](const sim::SimulatedScan& scan) {
    log.write(writer.scan(scan.record));
    recording.truth.push_back({scan.record.scan.stamp_s, scan.T_map_base});
  };
  sink.keep_on = [&](double share) {
    if (options.progress) {
      options.progress(recording.truth.size(), share);
    }
    return !options.stop || !options.stop();
  };
  recording.summary = run_simulation(scene.config, plan, caster, sink);
  log.finish();
  return recording;
}

SimulateResult result_of(const sim::SimulationSummary& summary) {
  SimulateResult result;
  result.scans = summary.scans;
  result.odometry_lines = summary.odometry_records;
  result.beams = summary.beams;
  result.returns = summary.returns;
  result.duration_s = summary.duration_s;
  result.path_m = summary.path_m;
  result.interrupted = !summary.is_whole;
  return result;
}

}  // namespace

SimulateResult simulate(const SimulateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const std::string scene_file = find_scene(options.scene, options.scene_folders);
  SceneFile scene = read_scene(scene_file);
  apply_options(options, scene);
  const std::string& path_source = options.trajectory ? *options.trajectory : scene_file;
  const sim::MotionPlan plan = plan_of(scene, path_source);
  const sim::RayCaster caster(triangulate(scene.scene), {options.embree_isa});
  const double clearance_m = checked_clearance_m(scene, plan, caster.mesh(), path_source);

  AtomicFileSet files;
  AtomicFile& log_file = files.add(options.output);
  const std::string truth_name = truth_file_of(options.output);
  AtomicFile& truth_file = files.add(truth_name);
  TextSink log(log_file);
  const Recording recording = record(options, scene, plan, caster, log);
  truth_file.write(tum_text(recording.truth));
  files.commit();  // the files themselves are gone after this

  SimulateResult result = result_of(recording.summary);
  result.scene_file = scene_file;
  result.log_file = options.output;
  result.truth_file = truth_name;
  result.triangles = caster.mesh().triangles.size();
  result.log_bytes = log.bytes();
  result.clearance_m = clearance_m;
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace gdtslam

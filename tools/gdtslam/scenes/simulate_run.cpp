#include "simulate_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "engine/io/atomic_file.hpp"
#include "engine/io/did_you_mean.hpp"
#include "engine/io/logs/carmen_writer.hpp"
#include "engine/io/logs/tum_row.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "engine/sim/chassis.hpp"
#include "engine/sim/surface_distance.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/error.hpp"
#include "scene_file.hpp"
#include "scene_parts.hpp"
#include "simulated_files.hpp"

namespace gdtslam {
namespace {

constexpr double kClearanceLimit_m = 2.0;
// The robot can drive over anything up to this height.
constexpr double kGroundClearance_m = 0.02;

/// Applies an option. The scene was valid before, so any fault is the option's.
template <class Value>
void state(std::string_view option, const std::optional<Value>& stated, Value& value, SceneFile& scene) {
  if (!stated) return;
  value = *stated;
  match_laser(scene.config);
  if (const std::vector<std::string> faults = validate(scene.config); !faults.empty()) {
    throw UsageError(fmt::format("{}: {}", option, faults.front()));
  }
}

void apply_laser(const SimulateOptions& options, SceneFile& scene) {
  sim::LaserModel& laser = scene.config.laser;
  if (options.laser) {
    const std::optional<sim::LaserModel> preset = sim::laser_preset(*options.laser);
    if (!preset) {
      const std::vector<std::string>& names = sim::laser_preset_names();
      throw UsageError(fmt::format("unknown laser '{}'{}; there are {}", *options.laser,
                                   did_you_mean(*options.laser, names), fmt::join(names, ", ")));
    }
    scene.laser = *options.laser;
    laser = *preset;
  }
  if (options.is_exact) {
    laser.noise_constant_m = 0.0;
    laser.noise_share = 0.0;
    laser.range_resolution_m = 0.0;
    laser.drop_out_share = 0.0;
  }
  state("--mirror-rate", options.mirror_rate_hz, laser.mirror_rate_hz, scene);
  state("--noise", options.noise_m, laser.noise_constant_m, scene);
  state("--resolution", options.range_resolution_m, laser.range_resolution_m, scene);
}

void apply_nodding(const SimulateOptions& options, SceneFile& scene) {
  std::optional<sim::NoddingModel>& nodding = scene.config.nodding;
  const bool asks = options.nod_mode || options.crank_rate_hz || options.ticks_per_turn || options.elevation_error_rad;
  if (options.linkage || (asks && !nodding)) {
    if (!nodding) nodding.emplace();
    const std::string linkage = options.linkage.value_or(std::string(calib::kDefaultLinkage));
    state("--linkage", std::optional(resolve_linkage(linkage)), nodding->truth, scene);
  }
  if (!nodding) return;
  if (options.nod_mode) state("--nod", std::optional(nod_mode(*options.nod_mode)), nodding->mode, scene);
  state("--crank-rate", options.crank_rate_hz, nodding->crank_rate_hz, scene);
  if (options.is_exact) make_exact(nodding->truth.encoder);
  state("--elevation-error", options.elevation_error_rad, nodding->elevation_error_rad, scene);
  state("--ticks", options.ticks_per_turn, nodding->truth.encoder.ticks_per_turn, scene);
}

void apply_motion(const SimulateOptions& options, SceneFile& scene) {
  sim::MotionLimits& limits = scene.limits;
  limits.speed_m_per_s = options.speed_m_per_s.value_or(limits.speed_m_per_s);
  limits.turn_rate_rad_per_s = options.turn_rate_rad_per_s.value_or(limits.turn_rate_rad_per_s);
  if (const std::vector<std::string> faults = validate(limits); !faults.empty()) {
    throw UsageError("--speed, --turn-rate: " + faults.front());
  }
}

void apply_options(const SimulateOptions& options, SceneFile& scene) {
  apply_laser(options, scene);
  apply_nodding(options, scene);
  apply_motion(options, scene);
  state("--sway", options.sway_tilt_rad, scene.config.chassis.sway_tilt_rad, scene);
  state("--sway", options.sway_heave_m, scene.config.chassis.sway_heave_m, scene);
  scene.config.stamps_first_beam = options.mirror_rate_hz && !scene.config.nodding;
  state("--rate", options.scan_rate_hz, scene.config.scan_rate_hz, scene);
  if (options.trajectory) {
    scene.waypoints = read_waypoints(*options.trajectory);
  }
  scene.config.seed = options.seed;
  if (const std::vector<std::string> faults = validate(scene.config); !faults.empty()) {
    throw UsageError(faults.front());
  }
}

sim::MotionPlan make_plan(const SceneFile& scene, const std::string& source) {
  if (scene.waypoints.empty()) {
    throw ConfigError({source, 0}, "has no waypoints: add them, or give --trajectory FILE");
  }
  try {
    const auto& nodding = scene.config.nodding;
    sim::MotionPlan plan(nodding ? with_scan_stops(*nodding, scene.waypoints) : scene.waypoints, scene.limits);
    require_few_records(scene.config, plan.duration_s());
    return plan;
  } catch (const ConfigError& error) {
    throw ConfigError({source, 0}, error.what());
  }
}

// Poses of the robot's centre along its path, about 5 cm apart.
std::vector<Pose2> places_along(const SceneFile& scene, const sim::MotionPlan& plan) {
  constexpr double kStep_m = 0.05;
  constexpr double kMostPlaces = 2e6;
  const double wanted = plan.duration_s() * scene.limits.speed_m_per_s / kStep_m;
  const auto count = static_cast<std::size_t>(std::clamp(wanted, 2.0, kMostPlaces));
  std::vector<Pose2> places;
  places.reserve(count + 1);
  for (std::size_t i = 0; i <= count; ++i) {
    const double time_s = plan.duration_s() * static_cast<double>(i) / static_cast<double>(count);
    places.push_back(base_pose(scene.config.wheels, plan.state_at(time_s)));
  }
  return places;
}

std::string place_text(const Point2& place_m) {
  return "(" + fixed_text(place_m.x(), 2) + ", " + fixed_text(place_m.y(), 2) + ")";
}

// Throws ConfigError if a wheel would climb or fall over an edge between two places.
void check_wheels(const SceneFile& scene, const std::vector<Pose2>& places, const std::string& source) {
  constexpr double kHighestStep_m = 0.03;
  if (scene.config.floor_parts.empty()) return;
  const sim::Chassis chassis(scene.config);
  std::array<double, 4> last_m = chassis.floor_below_m(places.front());
  for (const Pose2& place : places) {
    const std::array<double, 4> floor_m = chassis.floor_below_m(place);
    for (std::size_t wheel = 0; wheel < floor_m.size(); ++wheel) {
      const double step_m = std::fabs(floor_m[wheel] - last_m[wheel]);
      if (step_m <= kHighestStep_m) continue;
      throw ConfigError({source, 0}, "the floor below a wheel steps by " + fixed_text(step_m, 3) + " m near " +
                                         place_text(place.translation()) +
                                         ": add a ramp, make it wider or flatter, or move the waypoints there");
    }
    last_m = floor_m;
  }
}

// The smallest clearance and its place. Places whose floor is equally high, to within the ground clearance or a 64th of
// the path's rise, are measured together against what stands up to the body's height over that floor.
double least_clearance_m(const SceneFile& scene, const sim::TriangleMesh& obstacles, const std::vector<Pose2>& places,
                         Point2& nearest_m) {
  std::vector<double> over_m;
  over_m.reserve(places.size());
  for (const Pose2& place : places) {
    over_m.push_back(floor_height_m(scene.config.floor_parts, scene.config.floor_m, place.translation()) -
                     scene.config.floor_m);
  }
  const double step_m = std::max(kGroundClearance_m, *std::max_element(over_m.begin(), over_m.end()) / 64.0);
  std::map<long, std::vector<Point2>> levels;
  for (std::size_t i = 0; i < places.size(); ++i) {
    levels[std::lround(over_m[i] / step_m)].push_back(places[i].translation());
  }
  double least_m = std::numeric_limits<double>::infinity();
  for (const auto& [level, places_m] : levels) {
    const double floor_m = scene.config.floor_m + static_cast<double>(level) * step_m;
    const std::vector<double> clearances_m = sim::clearances_m(
        obstacles, {floor_m + kGroundClearance_m, floor_m + scene.body.height_m, kClearanceLimit_m}, places_m);
    const auto nearest = std::min_element(clearances_m.begin(), clearances_m.end());
    if (*nearest >= least_m) continue;
    least_m = *nearest;
    nearest_m = places_m[static_cast<std::size_t>(nearest - clearances_m.begin())];
  }
  return least_m;
}

// All parts but those of the floor; may be empty.
sim::TriangleMesh mesh_on_floor(sim::Scene scene, const std::string& source) {
  scene.floor_parts.clear();
  const bool is_bare = scene.walls.empty() && scene.boxes.empty() && scene.cylinders.empty() && scene.meshes.empty();
  return is_bare ? sim::TriangleMesh{} : triangulated(scene, source);
}

// Smallest clearance of the path. Throws ConfigError if the robot would touch something or fall off an edge.
double checked_clearance_m(const SceneFile& scene, const sim::MotionPlan& plan, const sim::TriangleMesh& mesh,
                           const std::string& source) {
  const std::vector<Pose2> places = places_along(scene, plan);
  check_wheels(scene, places, source);
  std::optional<sim::TriangleMesh> standing;
  const sim::TriangleMesh& obstacles =
      scene.config.floor_parts.empty() ? mesh : standing.emplace(mesh_on_floor(scene.scene, source));
  Point2 nearest_m;
  const double least_m = least_clearance_m(scene, obstacles, places, nearest_m);
  if (least_m < scene.body.radius_m) {
    throw ConfigError({source, 0}, "the path comes within " + fixed_text(least_m, 3) + " m of an obstacle at " +
                                       place_text(nearest_m) + ", but the robot's radius is " +
                                       fixed_text(scene.body.radius_m, 3) + " m: move the waypoints there");
  }
  return least_m;
}

// Enough decimals for multiples of the resolution, at least three from a millimetre on. Ranges that are not rounded
// keep all digits of a float beyond 4 m.
int range_decimals(const sim::LaserModel& laser) {
  constexpr double kMillimetre_m = 0.001;
  constexpr int kMostDecimals = 9;
  constexpr double kWhole = 1e-6;  // tolerance of a whole number
  if (laser.range_resolution_m == 0.0) return kMostDecimals;
  int decimals = laser.range_resolution_m >= kMillimetre_m ? 3 : 6;
  const auto is_enough = [&] {
    const double parts = laser.range_resolution_m * std::pow(10.0, decimals);
    return std::fabs(parts - std::round(parts)) < kWhole;
  };
  while (decimals < kMostDecimals && !is_enough()) ++decimals;
  return decimals;
}

std::string one_word(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c <= ' ' || c > '~'; }, '-');
  return text.empty() ? "-" : text;
}

// Header with the settings of the log, so that it can be reproduced.
std::string log_header(const SceneFile& scene, const CarmenWriter& writer) {
  const sim::SimulationConfig& config = scene.config;
  std::vector<std::pair<std::string, std::string>> parameters{
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
  if (config.nodding) {
    parameters.emplace_back("simulated_linkage", one_word(config.nodding->truth.name));
    parameters.emplace_back("simulated_crank_rate", fixed_text(config.nodding->crank_rate_hz, 6));
  }
  const std::pair<const char*, double> bodily[] = {
      {"simulated_sway_tilt", config.chassis.sway_tilt_rad},
      {"simulated_sway_heave", config.chassis.sway_heave_m},
      {"simulated_elevation_error", config.nodding ? config.nodding->elevation_error_rad : 0.0}};
  for (const auto& [name, value] : bodily) {
    if (value > 0.0) parameters.emplace_back(name, fixed_text(value, 6));
  }
  std::string header;
  for (const auto& [name, value] : parameters) {
    header += writer.parameter(name, value);
  }
  return header;
}

/// Beam times are written only if requested, so that a log of whole scans keeps its bytes.
UnsaidOfScans unsaid_facts(const SceneFile& scene) {
  const sim::LaserModel& laser = scene.config.laser;
  const bool are_timed = scene.config.stamps_first_beam;
  const double period_s = are_timed ? laser.time_of_beam_s(1) - laser.time_of_beam_s(0) : 0.0;
  // Single precision as in recordings, so that all formats have the same value.
  return {.max_range_m = laser.max_range_m, .beam_period_s = static_cast<double>(static_cast<float>(period_s))};
}

/// Files of a simulation, which appear together.
struct Output {
  Output(const SimulateOptions& options, const SceneFile& scene) : send(options.send) {
    if (send) {
      if (scene.config.nodding || options.truth_hits) {
        throw UsageError("a laser that nods and --truth-hits need files beside the log: give a file with --output");
      }
      return;
    }
    log.emplace(options.output, unsaid_facts(scene), files);
    truth_file = &files.add(sidecar_path(options.output, ".truth.tum"));
    if (scene.config.nodding) {
      files.add(sidecar_path(options.output, ".linkage.yaml")).write(linkage_text(scene.config.nodding->truth));
      elevations.emplace(files.add(sidecar_path(options.output, ".elevation.csv")));
    }
    if (options.truth_hits) hits.emplace(files.add(sidecar_path(options.output, ".truth.ply")));
  }

  void write(std::optional<double> stamp_s, std::string_view lines) {
    sent_bytes += send ? lines.size() : 0;
    if (send) {
      send(stamp_s, lines);
    } else {
      log->write(lines);
    }
  }
  // Writes and publishes the files; call it last.
  void finish() {
    if (!log) return;
    log->finish();
    if (hits) hits->finish();
    truth_file->write(truth);
    files.commit();
  }

  AtomicFileSet files;
  std::optional<SimulatedLog> log;
  std::function<void(std::optional<double>, std::string_view)> send;
  std::uint64_t sent_bytes = 0;
  AtomicFile* truth_file = nullptr;
  std::optional<ElevationRows> elevations;
  std::optional<HitCloud> hits;
  std::string truth;  ///< rows of the trajectory in space
  std::uint64_t scans = 0;
};

sim::SimulationSummary record(const SimulateOptions& options, const SceneFile& scene, const sim::MotionPlan& plan,
                              const sim::RayCaster& caster, Output& output) {
  CarmenWriter writer(range_decimals(scene.config.laser));
  const double limit_m = scene.config.laser.max_range_m;
  output.write(std::nullopt, log_header(scene, writer));
  sim::SimulationSink sink;
  sink.odometry = [&](const Odometry& odometry) { output.write(odometry.stamp_s, writer.odometry(odometry)); };
  sink.encoder = [&](const Encoder& encoder) { output.write(encoder.stamp_s, writer.encoder(encoder)); };
  sink.scan = [&](const sim::SimulatedScan& scan) {
    output.write(scan.record.scan.stamp_s, writer.scan(scan.record));
    output.truth += tum_row(scan.record.scan.stamp_s, scan.T_map_base);
    ++output.scans;
    if (output.elevations) output.elevations->add(scan);
    if (output.hits) output.hits->add(scan, limit_m);
  };
  sink.keep_on = [&](double share) {
    if (options.progress) options.progress(output.scans, share);
    return !options.stop || !options.stop();
  };
  sim::SimulationSummary summary = run_simulation(scene.config, plan, caster, sink);
  output.finish();
  return summary;
}

}  // namespace

SimulateResult simulate(const SimulateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const std::string scene_file = find_scene(options.scene, options.scene_folders);
  SceneFile scene = read_scene(scene_file);
  apply_options(options, scene);
  const std::string& path_source = options.trajectory ? *options.trajectory : scene_file;
  const sim::MotionPlan plan = make_plan(scene, path_source);
  const sim::RayCaster caster(triangulated(scene.scene, scene_file), {options.embree_isa});
  const double clearance_m = checked_clearance_m(scene, plan, caster.mesh(), path_source);

  Output output(options, scene);
  SimulateResult result;
  static_cast<sim::SimulationSummary&>(result) = record(options, scene, plan, caster, output);
  result.log_bytes = output.log ? output.log->bytes() : output.sent_bytes;
  if (output.log) result.left_out = output.log->left_out();
  if (output.log) result.truth_file = sidecar_path(options.output, ".truth.tum");
  if (output.elevations) result.linkage_file = sidecar_path(options.output, ".linkage.yaml");
  if (output.elevations) result.elevation_file = sidecar_path(options.output, ".elevation.csv");
  if (output.hits) result.hits_file = sidecar_path(options.output, ".truth.ply");
  result.scene_file = scene_file;
  result.log_file = options.output;
  result.triangles = caster.mesh().triangles.size();
  result.clearance_m = clearance_m;
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace gdtslam

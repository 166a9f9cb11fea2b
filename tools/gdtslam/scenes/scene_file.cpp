#include "scene_file.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/did_you_mean.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/yaml/checked_yaml.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "scene_parts.hpp"

namespace gdtslam {
namespace {

constexpr Quantity kShare{Unit::kShare};
constexpr Quantity kSpeed{Unit::kMetre, "/s"};
constexpr Quantity kAcceleration{Unit::kMetre, "/s^2"};
constexpr Quantity kTurnRate{Unit::kRadian, "/s"};
constexpr Quantity kTurnAcceleration{Unit::kRadian, "/s^2"};

void read_laser(const YamlValue& value, SceneFile& scene) {
  sim::LaserModel& laser = scene.config.laser;
  Pose2& T_base_laser = scene.config.T_base_laser;
  const auto read_preset = [&](const YamlValue& preset) {
    scene.laser = preset.text();
    const std::optional<sim::LaserModel> known = sim::laser_preset(scene.laser);
    if (!known) {
      preset.refuse("unknown laser '" + scene.laser + "'" + did_you_mean(scene.laser, sim::laser_preset_names()));
    }
    laser = *known;
  };
  const auto read_mount = [&](const YamlValue& mount) {
    read_fields(
        mount,
        {{"x", kLength, T_base_laser.x_m}, {"y", kLength, T_base_laser.y_m}, {"yaw", kAngle, T_base_laser.theta_rad}});
  };
  read_fields(value, {{"preset", read_preset},
                      {"first_bearing", kAngle, laser.first_bearing_rad},
                      {"bearing_step", kAngle, laser.bearing_step_rad},
                      {"beams", [&](const YamlValue& beams) { laser.beam_count = beams.count(); }},
                      {"min_range", kLength, laser.min_range_m},
                      {"max_range", kLength, laser.max_range_m},
                      {"no_return", kLength, laser.no_return_m},
                      {"noise", kLength, laser.noise_constant_m},
                      {"noise_share", kShare, laser.noise_share},
                      {"range_resolution", kLength, laser.range_resolution_m},
                      {"drop_outs", kShare, laser.drop_out_share},
                      {"mirror_rate", kFrequency, laser.mirror_rate_hz},
                      {"height", kLength, scene.config.laser_height_m},
                      {"mount", read_mount}});
  value.require_none(validate(laser));
}

void read_wheels(const YamlValue& value, sim::WheelModel& wheels) {
  read_fields(value, {{"track_width", kLength, wheels.drive.track_width_m},
                      {"centre_ahead_of_axle", kLength, wheels.drive.centre_ahead_of_axle_m},
                      {"track_width_scale", kNumber, wheels.track_width_scale},
                      {"left_scale", kNumber, wheels.left_scale},
                      {"right_scale", kNumber, wheels.right_scale},
                      {"slip", kLength, wheels.slip_m_per_sqrt_m},
                      {"ticks_per_metre", kNumber, wheels.ticks_per_m}});
  value.require_none(validate(wheels));
}

void read_chassis(const YamlValue& value, sim::ChassisModel& chassis) {
  read_fields(value, {{"wheelbase", kLength, chassis.wheelbase_m},
                      {"sway_tilt", kAngle, chassis.sway_tilt_rad},
                      {"sway_heave", kLength, chassis.sway_heave_m},
                      {"sway_wavelength", kLength, chassis.sway_wavelength_m}});
  value.require_none(validate(chassis));
}

void read_motion(const YamlValue& value, sim::MotionLimits& limits) {
  read_fields(value, {{"speed", kSpeed, limits.speed_m_per_s},
                      {"acceleration", kAcceleration, limits.acceleration_m_per_s2},
                      {"turn_rate", kTurnRate, limits.turn_rate_rad_per_s},
                      {"turn_acceleration", kTurnAcceleration, limits.turn_acceleration_rad_per_s2},
                      {"corner_cut", kLength, limits.corner_cut_m},
                      {"spin_above", kAngle, limits.spin_above_rad}});
  value.require_none(validate(limits));
}

void read_body(const YamlValue& value, RobotBody& body) {
  read_fields(value, {{"radius", kLength, body.radius_m}, {"height", kLength, body.height_m}});
  if (!(body.radius_m >= 0.0 && body.radius_m <= 10.0)) {
    value.refuse("radius must be 0 to 10 m");
  }
  if (!(body.height_m >= 0.01 && body.height_m <= 100.0)) {
    value.refuse("height must be 1 cm to 100 m");
  }
}

sim::Waypoint read_waypoint(const YamlValue& value) {
  sim::Waypoint waypoint;
  if (value.is_list()) {
    waypoint.position_m = value.point();
    return waypoint;
  }
  read_fields(value, {required({"at", waypoint.position_m}),
                      {"speed", [&](const YamlValue& speed) { waypoint.speed_m_per_s = speed.number(kSpeed); }},
                      {"corner_cut", [&](const YamlValue& cut) { waypoint.corner_cut_m = cut.number(kLength); }},
                      {"pause", kTime, waypoint.pause_s},
                      {"reverse", waypoint.is_reverse}});
  return waypoint;
}

std::vector<sim::Waypoint> read_waypoint_list(const YamlValue& list) {
  std::vector<sim::Waypoint> waypoints;
  for (const YamlValue& value : list.entries()) waypoints.push_back(read_waypoint(value));
  return waypoints;
}

void read_robot(const YamlValue& value, SceneFile& scene) {
  read_fields(value, {{"body", [&](const YamlValue& body) { read_body(body, scene.body); }},
                      {"laser", [&](const YamlValue& laser) { read_laser(laser, scene); }},
                      {"wheels", [&](const YamlValue& wheels) { read_wheels(wheels, scene.config.wheels); }},
                      {"chassis", [&](const YamlValue& chassis) { read_chassis(chassis, scene.config.chassis); }},
                      {"motion", [&](const YamlValue& motion) { read_motion(motion, scene.limits); }},
                      {"nodding", [&](const YamlValue& nodding) { scene.config.nodding = read_nodding(nodding); }}});
}

YamlValue read_document(const std::string& file) {
  return {parse_yaml<ConfigError>(read_text<ConfigError>(file, kMaxSceneBytes), file), file, ""};
}

// Names of the scenes in a folder, sorted so that hints do not depend on the file system.
std::vector<std::string> scenes_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const std::filesystem::path& entry : list_folder(folder, error)) {
    if (entry.extension() == ".yaml") {
      names.push_back(entry.stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

SceneFile read_scene(const std::string& file) {
  const YamlValue root = read_document(file);
  SceneFile scene;
  scene.name = std::filesystem::path(file).stem().string();
  scene.laser = sim::laser_preset_names().front();
  scene.config.laser = *sim::laser_preset(scene.laser);
  std::string description;
  const auto read_recording = [&](const YamlValue& recording) {
    read_fields(recording, {{"scan_rate", kFrequency, scene.config.scan_rate_hz},
                            {"odometry_rate", kFrequency, scene.config.odometry_rate_hz}});
  };
  std::vector<YamlField> fields{
      required({"gdtslam_scene", require_version_1}),
      {"name", scene.name},
      {"description", description},
      {"robot", [&](const YamlValue& robot) { read_robot(robot, scene); }},
      {"recording", read_recording},
      {"waypoints", [&](const YamlValue& list) { scene.waypoints = read_waypoint_list(list); }}};
  for (YamlField& part : scene_part_fields(scene.scene)) fields.push_back(std::move(part));
  read_fields(root, fields);
  match_laser(scene.config);
  scene.config.floor_parts = scene.scene.floor_parts;
  scene.config.floor_m = scene.scene.floor_m.value_or(0.0);
  const std::vector<std::string> faults = validate(scene.config);
  if (!faults.empty()) root.refuse_below(faults.front());
  return scene;
}

sim::TriangleMesh triangulated(const sim::Scene& scene, const std::string& file) {
  try {
    return triangulate(scene);
  } catch (const ConfigError& error) {
    throw ConfigError({file, 0}, error.what());
  }
}

std::vector<sim::Waypoint> read_waypoints(const std::string& file) {
  std::vector<sim::Waypoint> waypoints;
  read_fields(read_document(file),
              {required({"gdtslam_trajectory", require_version_1}),
               required({"waypoints", [&](const YamlValue& list) { waypoints = read_waypoint_list(list); }})});
  return waypoints;
}

std::string find_scene(const std::string& scene, const std::vector<std::string>& folders) {
  // A folder of that name may be a simulation's output; a pipe is accepted like a file.
  std::error_code ignored;
  if (std::filesystem::exists(scene, ignored) && !std::filesystem::is_directory(scene, ignored)) return scene;
  std::vector<std::string> names;
  std::string looked_in;
  for (const std::string& folder : folders) {
    for (const std::string& name : {scene, scene + ".yaml"}) {
      const std::filesystem::path candidate = std::filesystem::path(folder) / name;
      if (std::filesystem::is_regular_file(candidate, ignored)) {
        return candidate.string();
      }
    }
    const std::vector<std::string> known = scenes_in(folder);
    names.insert(names.end(), known.begin(), known.end());
    looked_in += (looked_in.empty() ? " in " : ", ") + folder;
  }
  throw FileError(scene, "is neither a file nor a scene" + looked_in + did_you_mean(scene, names));
}

}  // namespace gdtslam

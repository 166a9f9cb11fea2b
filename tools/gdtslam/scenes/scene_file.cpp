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

Pose2 read_mount(const YamlValue& value) {
  YamlMapping mapping(value);
  Pose2 T_base_laser;
  mapping.read("x", kLength, T_base_laser.x_m);
  mapping.read("y", kLength, T_base_laser.y_m);
  mapping.read("yaw", kAngle, T_base_laser.theta_rad);
  mapping.finish();
  return T_base_laser;
}

void read_laser(const YamlValue& value, SceneFile& scene) {
  YamlMapping mapping(value);
  sim::LaserModel& laser = scene.config.laser;
  if (const auto preset = mapping.find("preset")) {
    scene.laser = preset->text();
    const std::optional<sim::LaserModel> known = sim::laser_preset(scene.laser);
    if (!known) {
      preset->refuse("unknown laser '" + scene.laser + "'" + did_you_mean(scene.laser, sim::laser_preset_names()));
    }
    laser = *known;
  }
  mapping.read("first_bearing", kAngle, laser.first_bearing_rad);
  mapping.read("bearing_step", kAngle, laser.bearing_step_rad);
  read_given(mapping, "beams", [&](const YamlValue& beams) { laser.beam_count = beams.count(); });
  mapping.read("min_range", kLength, laser.min_range_m);
  mapping.read("max_range", kLength, laser.max_range_m);
  mapping.read("no_return", kLength, laser.no_return_m);
  mapping.read("noise", kLength, laser.noise_constant_m);
  mapping.read("noise_share", kShare, laser.noise_share);
  mapping.read("range_resolution", kLength, laser.range_resolution_m);
  mapping.read("drop_outs", kShare, laser.drop_out_share);
  mapping.read("mirror_rate", kFrequency, laser.mirror_rate_hz);
  mapping.read("height", kLength, scene.config.laser_height_m);
  read_given(mapping, "mount", [&](const YamlValue& mount) { scene.config.T_base_laser = read_mount(mount); });
  mapping.finish();
  value.require_none(validate(laser));
}

void read_wheels(const YamlValue& value, sim::WheelModel& wheels) {
  YamlMapping mapping(value);
  mapping.read("track_width", kLength, wheels.drive.track_width_m);
  mapping.read("centre_ahead_of_axle", kLength, wheels.drive.centre_ahead_of_axle_m);
  mapping.read("track_width_scale", kNumber, wheels.track_width_scale);
  mapping.read("left_scale", kNumber, wheels.left_scale);
  mapping.read("right_scale", kNumber, wheels.right_scale);
  mapping.read("slip", kLength, wheels.slip_m_per_sqrt_m);
  mapping.read("ticks_per_metre", kNumber, wheels.ticks_per_m);
  mapping.finish();
  value.require_none(validate(wheels));
}

void read_motion(const YamlValue& value, sim::MotionLimits& limits) {
  YamlMapping mapping(value);
  mapping.read("speed", kSpeed, limits.speed_m_per_s);
  mapping.read("acceleration", kAcceleration, limits.acceleration_m_per_s2);
  mapping.read("turn_rate", kTurnRate, limits.turn_rate_rad_per_s);
  mapping.read("turn_acceleration", kTurnAcceleration, limits.turn_acceleration_rad_per_s2);
  mapping.read("corner_cut", kLength, limits.corner_cut_m);
  mapping.read("spin_above", kAngle, limits.spin_above_rad);
  mapping.finish();
  value.require_none(validate(limits));
}

void read_body(const YamlValue& value, RobotBody& body) {
  YamlMapping mapping(value);
  mapping.read("radius", kLength, body.radius_m);
  mapping.read("height", kLength, body.height_m);
  mapping.finish();
  if (!(body.radius_m >= 0.0 && body.radius_m <= 10.0)) {
    value.refuse("radius must be 0 to 10 m");
  }
  if (!(body.height_m >= 0.01 && body.height_m <= 100.0)) {
    value.refuse("height must be 1 cm to 100 m");
  }
}

void read_recording(const YamlValue& value, sim::SimulationConfig& config) {
  YamlMapping mapping(value);
  mapping.read("scan_rate", kFrequency, config.scan_rate_hz);
  mapping.read("odometry_rate", kFrequency, config.odometry_rate_hz);
  mapping.finish();
}

sim::Waypoint read_waypoint(const YamlValue& value) {
  sim::Waypoint waypoint;
  if (value.is_list()) {
    waypoint.position_m = value.point();
    return waypoint;
  }
  YamlMapping mapping(value);
  waypoint.position_m = mapping.require("at").point();
  read_given(mapping, "speed", [&](const YamlValue& speed) { waypoint.speed_m_per_s = speed.number(kSpeed); });
  read_given(mapping, "corner_cut", [&](const YamlValue& cut) { waypoint.corner_cut_m = cut.number(kLength); });
  mapping.read("pause", kTime, waypoint.pause_s);
  mapping.read("reverse", waypoint.is_reverse);
  mapping.finish();
  return waypoint;
}

std::vector<sim::Waypoint> read_waypoint_list(const std::vector<YamlValue>& values) {
  std::vector<sim::Waypoint> waypoints;
  waypoints.reserve(values.size());
  for (const YamlValue& value : values) waypoints.push_back(read_waypoint(value));
  return waypoints;
}

void read_robot(const YamlValue& value, SceneFile& scene) {
  YamlMapping mapping(value);
  read_given(mapping, "body", [&](const YamlValue& body) { read_body(body, scene.body); });
  read_given(mapping, "laser", [&](const YamlValue& laser) { read_laser(laser, scene); });
  read_given(mapping, "wheels", [&](const YamlValue& wheels) { read_wheels(wheels, scene.config.wheels); });
  read_given(mapping, "motion", [&](const YamlValue& motion) { read_motion(motion, scene.limits); });
  read_given(mapping, "nodding", [&](const YamlValue& nodding) { scene.config.nodding = read_nodding(nodding); });
  mapping.finish();
}

// The key of a fault of the recording, "recording: scan_rate must be ...", where the file has it: its line is told.
YamlValue recording_key(const YamlValue& root, const std::string& fault) {
  constexpr std::string_view kRecording = "recording: ";
  if (!fault.starts_with(kRecording)) return root;
  const YAML::Node recording = root.node()["recording"];
  if (!recording || !recording.IsMap()) return root;
  const YAML::Node key =
      recording[fault.substr(kRecording.size(), fault.find(' ', kRecording.size()) - kRecording.size())];
  return {key ? key : recording, root.file(), ""};
}

void require_sound(const YamlValue& root, const sim::SimulationConfig& config) {
  const std::vector<std::string> faults = validate(config);
  if (!faults.empty()) recording_key(root, faults.front()).refuse(faults.front());
}

// Opens the document and checks the key that names its format and version.
YamlMapping open_document(const std::string& file, const std::string& format) {
  YamlMapping root(YamlValue(parse_yaml<ConfigError>(read_text<ConfigError>(file, kMaxSceneBytes), file), file, ""));
  const YamlValue version = root.require(format);
  if (version.text() != "1") {
    version.refuse("version '" + version.text() + "' is not known; this program reads version 1");
  }
  return root;
}

// The names of the scenes in a folder, sorted, so that a hint does not depend on the file system.
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
  YamlMapping root = open_document(file, "gdtslam_scene");
  SceneFile scene;
  scene.name = std::filesystem::path(file).stem().string();
  scene.laser = sim::laser_preset_names().front();
  scene.config.laser = *sim::laser_preset(scene.laser);
  std::string description;
  root.read("name", scene.name);
  root.read("description", description);
  scene.scene = read_scene_parts(root);
  read_given(root, "robot", [&](const YamlValue& robot) { read_robot(robot, scene); });
  read_given(root, "recording", [&](const YamlValue& recording) { read_recording(recording, scene.config); });
  scene.waypoints = read_waypoint_list(root.list("waypoints"));
  root.finish();
  match_laser(scene.config);
  require_sound(root.value(), scene.config);
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
  YamlMapping root = open_document(file, "gdtslam_trajectory");
  const YamlValue list = root.require("waypoints");
  root.finish();
  return read_waypoint_list(list.entries());
}

std::string find_scene(const std::string& scene, const std::vector<std::string>& folders) {
  // A folder of that name may be what was simulated from it; a pipe is as good as a file.
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

// Reads scenes and trajectories of the simulator as YAML (docs/simulation.md lists every key with unit and default).
// Unknown and duplicate keys, wrong types and values out of range throw ConfigError with file and line. Mesh paths are
// relative to the scene. Thread-safe; linear in the file.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/sim/motion_plan.hpp"
#include "gdtslam/sim/scene.hpp"
#include "gdtslam/sim/simulation.hpp"

namespace gdtslam {

/// Size of the robot: obstacles may not be closer to its path.
struct RobotBody {
  double radius_m = 0.25;  ///< 0: no collision check
  double height_m = 0.6;   ///< above the floor; higher obstacles are ignored
};

struct SceneFile {
  std::string name;
  std::string laser;  ///< preset that the laser is based on
  sim::Scene scene;
  RobotBody body;
  sim::SimulationConfig config;
  sim::MotionLimits limits;
  std::vector<sim::Waypoint> waypoints;  ///< empty: the caller provides them
};

/// Throws ConfigError, FileError, or InputError for a mesh.
SceneFile read_scene(const std::string& file);
/// The scene's surfaces. Throws ConfigError with the scene's file.
sim::TriangleMesh triangulated(const sim::Scene& scene, const std::string& file);

/// Reads the waypoints of a trajectory file.
std::vector<sim::Waypoint> read_waypoints(const std::string& file);

/// Path of a scene from a path or a name in one of the folders. Throws FileError that lists the places searched.
std::string find_scene(const std::string& scene, const std::vector<std::string>& folders);

}  // namespace gdtslam

// Scenes and trajectories of the simulator as YAML (docs/simulation.md lists every key with unit and default).
// Every key is checked: what is unknown, twice there, of the wrong kind or out of range throws ConfigError with file
// and line. Meshes are read from paths relative to the scene. Thread-safe; linear in the file.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/sim/motion_plan.hpp"
#include "gdtslam/sim/scene.hpp"
#include "gdtslam/sim/simulation.hpp"

namespace gdtslam {

/// The size of the robot: no obstacle may come closer to its path.
struct RobotBody {
  double radius_m = 0.25;  ///< 0: may drive through anything
  double height_m = 0.6;   ///< above the floor; what is higher is out of its way
};

struct SceneFile {
  std::string name;
  std::string laser;  ///< preset that the laser began from
  sim::Scene scene;
  RobotBody body;
  sim::SimulationConfig config;
  sim::MotionLimits limits;
  std::vector<sim::Waypoint> waypoints;  ///< may be empty: then the caller brings them
};

/// Throws ConfigError, FileError, or InputError for a mesh.
SceneFile read_scene(const std::string& file);
/// Its surfaces. Throws ConfigError with the scene's file.
sim::TriangleMesh triangulated(const sim::Scene& scene, const std::string& file);

/// The waypoints of a trajectory file.
std::vector<sim::Waypoint> read_waypoints(const std::string& file);

/// The file of a scene given as a path or as a name in one of the folders. Throws FileError that lists where it looked.
std::string find_scene(const std::string& scene, const std::vector<std::string>& folders);

}  // namespace gdtslam

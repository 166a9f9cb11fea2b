// Scenes of the simulator and the waypoints of its drives.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "target.hpp"
#include "tools/gdtslam/scenes/scene_file.hpp"

namespace gdtslam::fuzz {
namespace detail {

inline void check_waypoints(const std::vector<sim::Waypoint>& waypoints) {
  for (const sim::Waypoint& waypoint : waypoints) {
    require(waypoint.position_m.allFinite() && std::isfinite(waypoint.pause_s));
  }
}

}  // namespace detail

/// Beside the scene lie a mesh and a linkage that it may name.
inline void read_scene_text(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  static const bool is_ready = [] {
    folder.put("mesh.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 1\n3 0 1 2\n");
    folder.put("mount.yaml", "gdtslam_linkage: 1\npreset: paper-a\n");
    return true;
  }();
  require(is_ready);
  expect_typed<ConfigError, InputError, FileError>([&] {
    const SceneFile scene = read_scene(folder.put("scene.yaml", text_of(data)));
    detail::check_waypoints(scene.waypoints);
    require(scene.body.radius_m >= 0.0 && scene.body.height_m > 0.0);
    require(sim::validate(scene.config).empty());
  });
}

inline void read_waypoint_file(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  expect_typed<ConfigError>([&] { detail::check_waypoints(read_waypoints(folder.put("drive.yaml", text_of(data)))); });
}

inline constexpr std::array kSceneTargets{FuzzTarget{"scene", read_scene_text, 5},
                                          FuzzTarget{"waypoints", read_waypoint_file, 3}};

}  // namespace gdtslam::fuzz

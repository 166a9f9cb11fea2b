// A mesh from a file, set into a scene: scaled, then turned about z, then moved, p_map = R(yaw) * (scale * p_file) +
// position. z is up unless y_is_up, which first maps (x, y, z) to (x, -z, y). Thread-safe, linear.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {

/// Where an imported mesh stands in the scene.
struct MeshPlacement {
  double scale = 1.0;  ///< metres per unit of the file
  bool y_is_up = false;
  Vec3 position_m{0.0, 0.0, 0.0};
  double yaw_rad = 0.0;
};

/// The triangles keep their order; each names three of the vertices.
TriangleMesh placed_mesh(std::span<const std::array<float, 3>> vertices,
                         std::span<const std::array<std::uint32_t, 3>> triangles, const MeshPlacement& placement);

}  // namespace gdtslam::sim

// Triangles from the bytes of an OBJ, STL or PLY file; the caller reads the file, because sim reads none.
// The mesh is scaled, then turned about z, then moved: p_map = R(yaw) * (scale * p_file) + position. z is up unless
// y_is_up, which first maps (x, y, z) to (x, -z, y). Coordinates are the file's, in single precision.
// Cost: the parser's (Assimp). Thread-safe.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {

/// Where an imported mesh stands in the scene.
struct MeshPlacement {
  double scale = 1.0;  ///< metres per unit of the file
  bool y_is_up = false;
  Vec3 position_m{0.0, 0.0, 0.0};
  double yaw_rad = 0.0;
};

/// Throws InputError, naming `file_name`, for a format that is not known or bytes that hold no triangle. The format
/// follows the extension of the name; materials and textures are ignored.
TriangleMesh import_mesh(std::span<const std::byte> bytes, const std::string& file_name,
                         const MeshPlacement& placement);

}  // namespace gdtslam::sim

// Clouds for other programs, browsers and Blender among them: glTF 2.0 [Khronos2021], one file that needs nothing else;
// points with their colours, the robot's path as a line. Not by VTK's exporter, which needs a window with OpenGL. The
// file is written to a temporary name, synced and renamed; memory does not depend on the number of points. Thread-safe.
#pragma once

#include <span>
#include <string>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {

struct ModelInput {
  std::string name;
  std::span<const CloudPoint> cloud;
  std::span<const Colour> colours;         ///< one for each point
  const Trajectory* trajectory = nullptr;  ///< may be null
  Colour path_colour = ink::kCrank;
};

/// y up, as glTF has it: the map's (x, y, z) becomes (x, z, -y), metres. Colours are linear, as glTF wants them. Throws
/// FileError; InputError for a cloud without points.
void write_gltf(const std::string& path, const ModelInput& model);

}  // namespace gdtslam

// Exports clouds and linkages as .glb for other programs, for example browsers and Blender. A cloud is coloured points
// with the robot's path as a line; a linkage is its solids with an animation of one turn. VTK's own exporter is not
// used, because it needs a window with OpenGL. Thread-safe.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "viewer/scene/linkage/linkage_model.hpp"

namespace gdtslam {

struct CloudModel {
  std::string name;
  std::span<const CloudPoint> cloud;
  std::span<const Colour> colours;         ///< one for each point
  const Trajectory* trajectory = nullptr;  ///< may be null
};

/// y is up, as in glTF: the map's (x, y, z) becomes (x, z, -y), metres. Colours are linear, as in glTF. Throws
/// FileError; InputError for a cloud without points or beyond the 4 GiB of a .glb.
void write_cloud_glb(const std::string& path, const CloudModel& model);

/// Writes the parts as children of a node that turns z up into y up; the animation takes `turn_s`. Throws FileError.
void write_linkage_glb(const std::string& path, const std::string& name, const std::vector<SolidPart>& parts,
                       double turn_s);

}  // namespace gdtslam

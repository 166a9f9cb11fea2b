// Clouds and linkages for other programs, browsers and Blender among them, as .glb. A cloud is points with their
// colours and the robot's path as a line; a linkage is its solids and an animation of one turn. VTK's own exporter
// needs a window with OpenGL, so it is not used. Thread-safe.
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

/// y up, as glTF has it: the map's (x, y, z) becomes (x, z, -y), metres. Colours are linear, as glTF wants them. Throws
/// FileError; InputError for a cloud without points or one that is too large for a .glb, which ends at 4 GiB.
void write_cloud_glb(const std::string& path, const CloudModel& model);

/// The parts as nodes under one that turns z up into y up; the animation takes `turn_s`. Throws FileError.
void write_linkage_glb(const std::string& path, const std::string& name, const std::vector<SolidPart>& parts,
                       double turn_s);

}  // namespace gdtslam

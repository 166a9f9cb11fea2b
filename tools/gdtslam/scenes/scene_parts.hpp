// The parts of a scene file that can be seen: walls, boxes, cylinders, meshes, floor and ceiling.
#pragma once

#include "engine/io/yaml/checked_yaml.hpp"
#include "gdtslam/sim/scene.hpp"

namespace gdtslam {

/// Takes the keys wall_defaults, walls, boxes, cylinders, objects, place, meshes, floor and ceiling. Throws ConfigError
/// with file and line, FileError or InputError for a mesh.
sim::Scene read_scene_parts(YamlMapping& root);

}  // namespace gdtslam

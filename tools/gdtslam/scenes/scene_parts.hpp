// The sections of a scene file (docs/simulation.md lists every key) and what their readers share. The readers throw
// ConfigError with file and line.
#pragma once

#include <string>
#include <vector>

#include "engine/io/yaml/checked_yaml.hpp"
#include "gdtslam/sim/nodding.hpp"
#include "gdtslam/sim/scene.hpp"

namespace gdtslam {

inline constexpr Quantity kLength{Unit::kMetre};
inline constexpr Quantity kAngle{Unit::kRadian};
inline constexpr Quantity kTime{Unit::kSecond};
inline constexpr Quantity kNumber{Unit::kNone};
inline constexpr Quantity kFrequency{Unit::kNone, "Hz"};

/// Fields of the visible parts: wall_defaults, walls, boxes, cylinders, objects, place, meshes, floor and ceiling.
/// Their readers throw FileError or InputError for a mesh. `scene` must outlive the fields.
std::vector<YamlField> scene_part_fields(sim::Scene& scene);

/// The section robot.nodding: a laser on a nodding mount. A linkage file is looked for beside the scene.
sim::NoddingModel read_nodding(const YamlValue& value);

/// A mode by its name in scenes and options: continuous, stop-and-scan, stepped. Throws UsageError with the names.
sim::NodMode nod_mode(const std::string& name);

/// Makes the encoder as fine as a log can be: 2^30 ticks a turn.
void make_exact(calib::CrankEncoder& encoder);

}  // namespace gdtslam

// Readers of the sections of a scene file (docs/simulation.md lists every key). They throw ConfigError with file and
// line.
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

/// Fields of the visible parts: wall_defaults, walls, boxes, cylinders, objects, place, meshes, ramps, plates, sills,
/// floor and ceiling.
/// Their readers throw FileError or InputError for a mesh. `scene` must outlive the fields.
std::vector<YamlField> scene_part_fields(sim::Scene& scene);

/// Reads robot.nodding: a laser on a nodding mount. The path of a linkage file is relative to the scene.
sim::NoddingModel read_nodding(const YamlValue& value);

/// Parses a mode of scenes and options: continuous, stop-and-scan, stepped. Throws UsageError with the names.
sim::NodMode nod_mode(const std::string& name);

/// Sets the finest encoder that a log allows: 2^30 ticks a turn.
void make_exact(calib::CrankEncoder& encoder);

}  // namespace gdtslam

// The section robot.nodding of a scene: a laser on a nodding mount (docs/simulation.md lists every key).
#pragma once

#include <string>

#include "engine/io/yaml/checked_yaml.hpp"
#include "gdtslam/sim/nodding.hpp"

namespace gdtslam {

/// A mode by its name in scenes and options: continuous, stop-and-scan, stepped. Throws UsageError with the names.
sim::NodMode nod_mode(const std::string& name);

/// What makes the encoder tell the crank's angle as finely as a log can: 2^30 ticks a turn.
void make_exact(calib::CrankEncoder& encoder);

/// Throws ConfigError with file and line. A linkage file is looked for beside the scene.
sim::NoddingModel read_nodding(const YamlValue& value);

}  // namespace gdtslam

// Trajectories and relations as text, one row per pose (docs/formats.md). TUM rows are `stamp x y z qx qy qz qw`,
// seconds and metres, nine decimals. Thread-safe; O(rows). Files may be gzip; "-" is standard input.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// The rows of a trajectory in its order. Throws Error if a pose is not finite.
std::string tum_text(const Trajectory& trajectory);
/// Atomic. Also throws FileError.
void write_tum(const std::string& path, const Trajectory& trajectory);

/// Skips comments (#) and blank lines; keeps x, y and yaw. Throws InputError with file and line, FileError.
Trajectory read_tum(const std::string& path);
/// The same from memory; `name` is for messages.
Trajectory read_tum(std::span<const std::byte> data, const std::string& name);

/// Rows `t1 t2 x y z roll pitch yaw`: the pose at t2 in the frame of t1, metres and radians [Kuemmerle2009]. Throws
/// InputError with file and line, FileError.
std::vector<Relation> read_relations(const std::string& path);

}  // namespace gdtslam

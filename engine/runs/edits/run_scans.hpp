// The scans that a run's occupancy map is cast from, read once more: all that were matched where the run has copies of
// its logs, else its keyframes. Frames: as the poses given. One call belongs to one thread; memory for one scan.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/keyframes/keyframe_file.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// Where they are.
struct RunScans {
  const RunFiles& files;         ///< of the run
  const Trajectory& trajectory;  ///< one pose a scan
  const std::vector<RunKeyframe>& keyframes;
  const std::vector<std::size_t>& refused;  ///< scans that were not matched, ascending: they were not cast
};

/// Whether the run has what can be read in place of its logs.
bool has_log_copies(const std::string& folder);

/// Each scan as it was cast, with its pose, in log order; `take` may change the scan. Returns the number of scans.
/// Throws InputError where the copies are not of the run, FileError.
std::uint64_t for_each_cast_scan(const RunScans& run, const std::function<void(LaserScan& scan, const Pose2& T)>& take);

}  // namespace gdtslam

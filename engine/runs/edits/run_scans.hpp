// The scans that a run's occupancy map is cast from, read once more: all that were matched where its logs are as they
// were, else its keyframes. Frames: as the poses given. One call belongs to one thread; memory for one scan.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/keyframes/keyframe_file.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

/// The logs of a run, and how it read them.
struct RunLogs {
  std::vector<std::string> paths;
  ReadOptions options;
  ScanRange range;
  double odometry_delay_s = 0.0;
};

/// The logs that the run names; none if one of them is gone or was changed. Cost: the logs are read for their hashes.
std::optional<RunLogs> logs_of_run(const RunReader& run, const LogConfig& config);

/// The scans of a run, and the poses that they were matched at.
struct RunScans {
  const RunReader& run;
  const std::optional<RunLogs>& logs;
  const Trajectory& trajectory;  ///< one pose a scan
  const std::vector<RunKeyframe>& keyframes;
  const std::vector<std::size_t>& refused;  ///< scans that were not matched, ascending: they were not cast
};

/// Each scan as it was cast, with its pose, in log order; `take` may change the scan. Returns the number of scans.
/// Throws InputError where the logs are not of the run, FileError.
std::uint64_t for_each_cast_scan(const RunScans& run, const std::function<void(LaserScan& scan, const Pose2& T)>& take);

}  // namespace gdtslam

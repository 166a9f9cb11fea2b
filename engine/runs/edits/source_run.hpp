// A run as input of an edit: everything in its folder that has a frame, read and checked, and the scans for its
// occupancy map. Frame: the run's map. One call belongs to one thread; memory for one scan.
#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/runs/edits/edit_steps.hpp"
#include "engine/runs/folder/loop_files.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

struct SourceRun {
  RunReader reader;
  nlohmann::ordered_json report;
  Settings settings;
  RunKeyframes kept;
  std::vector<std::size_t> refused;  ///< scans that were not matched, ascending
  /// Trajectory (keyframes with all digits), keyframes, drives, doubts, counts, and the known facts of the closed path.
  MapOutcome outcome;
  GraphLines graph;                      ///< empty if the run closed no loops
  std::vector<std::size_t> sessions;     ///< number of scans of each run of a merged site
  std::optional<RecordedEdits> earlier;  ///< steps of earlier edits of the run
};

/// Throws InputError with advice if the folder is no run, its laser nods, or its files do not match; FileError.
SourceRun read_source_run(const std::string& folder);

/// Moves everything that has a frame to the new one. Covariances turn with their axes.
void move_to_frame(const Pose2& T_edited_run, SourceRun& run);

/// Calls `take` for each scan of the occupancy map in log order, with its pose and the share done before it; `take` may
/// change the scan. These are all matched scans from the run's logs, or its keyframes if a log is gone or was changed.
/// Returns true if they are from the logs. Throws InputError if the logs are not of the run, FileError.
bool for_each_cast_scan(const SourceRun& run,
                        const std::function<void(LaserScan& scan, const Pose2& T, double share)>& take);

}  // namespace gdtslam

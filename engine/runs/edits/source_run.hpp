// A run as it is edited: everything of its folder that has a frame, read and checked, and the scans that its occupancy
// map is cast from. Frame: the run's map. One call belongs to one thread; memory for one scan.
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
  /// Trajectory (keyframes with all digits), keyframes, drives, doubts, counts, and what is known of the closed path.
  MapOutcome outcome;
  GraphLines graph;                      ///< empty where the run closed no loops
  std::vector<std::size_t> sessions;     ///< number of scans of each run of a merged site
  std::optional<RecordedEdits> earlier;  ///< steps of earlier edits of the run
};

/// Throws InputError with what to do where the folder is no run, its laser nods, or its files do not belong together;
/// FileError.
SourceRun read_source_run(const std::string& folder);

/// Everything that has a frame, in the new one. Covariances are turned with their axes.
void move_to_frame(const Pose2& T_edited_run, SourceRun& run);

/// Each scan that the occupancy map was cast from, with its pose and the share of all that came before, in log order;
/// `take` may change the scan. These are all scans that were matched, read from the run's logs, or its keyframes if a
/// log is gone or was changed. Returns whether they came from the logs. Throws InputError if the logs are not of the
/// run, FileError.
bool for_each_cast_scan(const SourceRun& run,
                        const std::function<void(LaserScan& scan, const Pose2& T, double share)>& take);

}  // namespace gdtslam

// A run as it is edited: everything of its folder that has a frame, read and checked. Frame: the run's map. Plain data.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/runs/edits/edits_file.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/loops/graph_file.hpp"
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
  std::vector<std::size_t> sessions;     ///< of a merged site: how many scans the path of each of its runs has
  std::optional<RecordedEdits> earlier;  ///< where the run was edited already
};

/// Throws InputError with what to do where the folder is no run, its laser nods, or its files do not belong together;
/// FileError.
SourceRun read_source_run(const std::string& folder);

/// Everything that has a frame, in the new one. Covariances are turned with their axes.
void move_to_frame(const Pose2& T_edited_run, SourceRun& run);

/// "session-2.tum" for 1.
std::string session_file_name(std::size_t session);

}  // namespace gdtslam

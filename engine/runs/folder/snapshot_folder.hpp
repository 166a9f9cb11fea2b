// What `gdtslam live` keeps beside a run that is not finished: map and path so far, in the folder `snapshot` of the
// run's. It bears no mark, so it is known by what lies in it: its files, all of them, and nothing else.
#pragma once

#include <string>

namespace gdtslam {

inline constexpr const char* kSnapshotFolder = "snapshot";
inline constexpr const char* kSnapshotMap = "map.yaml";
inline constexpr const char* kSnapshotTrajectory = "trajectory.tum";

/// Whether that is a snapshot, which may be replaced and removed. A link to one is none.
bool is_snapshot(const std::string& folder);

/// Removes the files of a snapshot, and the folder if nothing else lies in it.
void remove_snapshot(const std::string& folder);

/// Throws UsageError where something else has the name of the run folder's snapshot.
void require_no_foreign_snapshot(const std::string& run_folder);

}  // namespace gdtslam

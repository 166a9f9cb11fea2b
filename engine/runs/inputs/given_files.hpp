// Trajectories and clouds that a command was given: the file itself, or the folder of the run that wrote it, whose
// report is checked as RunReader does. Another program's folder will do if it has a file of that name. Thread-safe.
#pragma once

#include <optional>
#include <string>

#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// Throws InputError where the folder has what is left of a run without its report (RunReader::is_broken_run): the file
/// `name` of it would be of nobody knows which run. The same where it holds the sites of a merge.
void refuse_broken_run(const std::string& folder, const char* name);

/// The poses of a TUM file, or of trajectory.tum in a folder. Throws FileError, and InputError that says what to give.
Trajectory given_trajectory(const std::string& given);

/// The file of a cloud: `given` unless that is a folder, then its cloud.ply. Nothing is said of the file itself, which
/// its reader checks. Throws InputError where the folder has none, with the reason that its run gives; FileError.
std::string given_cloud(const std::string& given);
/// The same, and the run that the cloud is of, for whoever has read it to ask its files() whether they are unchanged;
/// nothing where it is of none.
std::string given_cloud(const std::string& given, std::optional<RunReader>& run);

}  // namespace gdtslam

// The run of a unit as it lies in an atlas: whether it is there, whole, and what the plan asks for. Thread-safe.
#pragma once

#include <string>

#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

/// Whether the run has its report, which takes its name last: a look at one file where it has. Throws FileError where
/// that cannot be told, as behind a link that leads nowhere.
bool has_report(const std::string& atlas, const std::string& run);

/// Whether a run lies in that folder; an empty folder is none. Throws FileError for what is neither, and likewise.
bool is_run_there(const std::string& run_folder);

/// Holds every file that the report tells of against its bytes and its SHA-256. Throws InputError that names the first
/// one that is another or gone, and what to do in an atlas; FileError.
void require_whole_run(const std::string& run_folder);

/// That it is whole, and as one that these settings make and nobody has edited. Throws FileError, for the log is not to
/// blame.
void require_run_of_plan(const std::string& run_folder, const Settings& settings);

/// What is said of a run folder, with the advice that fits one in an atlas: a log that is mapped into it by `gdtslam
/// map` is mapped with other settings than the plan's.
std::string said_in_atlas(const std::string& message);

}  // namespace gdtslam

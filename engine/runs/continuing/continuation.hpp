// Finds what a run folder has to go on with: a run that is finished or was interrupted, or what a killed one left.
// Thread-safe.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "continue_file.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_folder.hpp"

namespace gdtslam {

struct Continuation {
  KeptRequest kept;
  std::string run;                  ///< the folder that was asked about
  std::filesystem::path leftover;   ///< of a killed run, to be taken over; empty: files are copied
  std::vector<std::string> copies;  ///< of the logs, as many as there are
  std::string remark;               ///< what its user should know, in a line; empty: nothing
  std::optional<RunFiles> files{};  ///< of a finished run, checked
};

/// What `run` has, and the logs that come after those of it; the first of them that it ends with already, as where a
/// command is repeated that was killed at its very end, are not added once more. Throws InputError where it has nothing
/// that can be gone on with, UsageError where more logs make no sense or another process writes there, FileError, and
/// kInterrupted where `stop`, which may be empty, becomes true while logs are compared.
Continuation continuation_of(const std::string& run, const std::vector<std::string>& more_logs,
                             const std::function<bool()>& stop);

/// The folder to write to, with the copies of the logs in it and continue.json. The leftover of a killed run is taken
/// over where the results come into the same folder.
std::unique_ptr<RunFolder> folder_to_continue(const Continuation& continuation, const std::string& path,
                                              ForeignFiles foreign);

}  // namespace gdtslam

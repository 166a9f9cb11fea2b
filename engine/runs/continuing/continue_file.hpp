// continue.json of a run: what it was asked for and which logs it read, so that it can be continued (docs/formats.md).
// Thread-safe; O(text), and what it takes to read the logs once for their hashes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/core/files/file_state.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

inline constexpr const char* kContinueFile = "continue.json";

/// A log that a run read.
struct KeptLog {
  std::string name;    ///< as it was given
  std::string path;    ///< absolute; of one that the run itself has, the name of that file
  std::string sha256;  ///< of the file; of a folder, of the hashes of its files in the order of their names
};

/// A request as far as it determines the result, and the logs; the rest has its defaults.
struct KeptRequest {
  MapRequest request;
  std::vector<KeptLog> logs;
  std::string linkage_sha256{};  ///< where the linkage is a file
};

/// A log that was mapped, whose state was `before` when that began; `kept_file` is the file in which the run keeps it,
/// if it does. Without a hash if the log is another by now, or cannot be read again. Throws FileError.
KeptLog kept_log(const std::string& log, const std::optional<FileState>& before, const std::string& kept_file);

/// Atomic. Throws FileError.
void write_continue_file(const std::string& file, const KeptRequest& kept);
/// Of the run in `folder`. Throws InputError or ConfigError where it is none of this version, FileError.
KeptRequest read_continue_file(const std::string& file, const std::string& folder);

/// The path of the log now: the name that it was given, if that still names it. Throws InputError where it is not
/// there, or has other bytes than the run in `folder` read.
std::string log_of_run(const KeptLog& log, const std::string& folder);

/// `request` with what the run in request.continued was asked for, and with its logs before its own. Throws what
/// read_continue_file() and log_of_run() throw, and UsageError where the logs cannot be added.
MapRequest continued_request(const MapRequest& request);

}  // namespace gdtslam

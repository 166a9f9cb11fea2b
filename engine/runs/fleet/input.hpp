// The bytes of a unit's log: hashed where they lie, or fetched by a command and hashed as they come. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "engine/core/files/file_state.hpp"
#include "gdtslam/core/error.hpp"
#include "plan.hpp"

namespace gdtslam {

/// Where a unit's log is now, and what it is.
struct UnitInput {
  std::string path;
  std::uint64_t bytes = 0;
  std::string sha256;          ///< of the file; of a folder, of its files' names and hashes
  std::string linkage_sha256;  ///< of the linkage that lies beside it; empty: none, or the plan has one
  /// The files that it lies in as they were before they were hashed, and the linkage beside it, nothing where there was
  /// none. Empty for a log that was fetched: nobody else has the copy.
  std::map<std::string, std::optional<FileState>> files{};
};

/// The log cannot be had here and now, which says nothing of other logs.
class LogUnavailable : public FileError {
 public:
  explicit LogUnavailable(const FileError& reason) : FileError(reason) {}
};

/// Looks at the log, or fetches it into `folder` by FleetPlan::get. Throws LogUnavailable where the log cannot be read
/// or the command fails, another FileError where the copy cannot be written, and Error(kInterrupted).
UnitInput unit_input(const FleetPlan& plan, const FleetUnit& unit, const std::string& folder,
                     const std::function<bool()>& stop);

/// The log is opened once to be hashed and once more to be mapped: throws LogUnavailable where it was changed or
/// replaced since unit_input(), so that what was mapped may not be what was hashed.
void require_unchanged(const FleetPlan& plan, const UnitInput& input);

/// First 16 hexadecimal digits of the SHA-256 of the program, what is asked of it, and the log's bytes.
std::string unit_name(const FleetPlan& plan, const UnitInput& input);

/// The command that gets an URI: each {} in `get` becomes the URI, quoted for a shell. Throws UsageError where there is
/// none.
std::string get_command(const std::string& get, const std::string& uri);

}  // namespace gdtslam

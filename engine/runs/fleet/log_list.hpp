// Which logs a fleet command maps, and which of them are those of a shard. No log is opened. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gdtslam {

/// A log to be mapped: a file, or the folder of a ROS 2 bag.
struct FleetLog {
  std::string path;  ///< absolute
  std::uint64_t bytes = 0;
  friend bool operator==(const FleetLog&, const FleetLog&) = default;
};

/// Whether a file's name ends as those of logs do: .log, .clf, .csv, .jsonl, .bag, .mcap or .db3, each plain or packed
/// (.gz, .bz2, .xz, .zst).
bool has_name_of_a_log(const std::filesystem::path& file);

/// The logs that are named and those in folders that are named, each once: the largest first, then by path. A folder is
/// searched with all below it, except hidden folders, links to folders, run folders and atlases. Throws FileError for
/// what is not there; InputError for a folder without a log, and for a path that is no UTF-8 or has control characters.
std::vector<FleetLog> find_logs(const std::vector<std::string>& named);

/// One of `count` parts of the logs, which may be mapped anywhere and at any time.
struct Shard {
  std::size_t number = 1;  ///< from 1
  std::size_t count = 1;
};

/// "3/20". Throws UsageError.
Shard parse_shard(const std::string& text);

/// Every count-th log, so that shards are about even.
std::vector<FleetLog> logs_of_shard(const std::vector<FleetLog>& logs, const Shard& shard);

}  // namespace gdtslam

// The folder of a fleet's maps (docs/formats.md#atlas): options.txt, lists of logs, a record and a run folder for each
// log, and what `gdtslam fleet finish` makes of them. Thread-safe.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "fleet_record.hpp"
#include "log_list.hpp"

namespace gdtslam {

inline constexpr const char* kOptionsFile = "options.txt";

/// Makes the folder, and writes down the options, which are the same for all logs of an atlas, and which logs there
/// are. Every shard does so. Throws UsageError if the atlas has other options or the folder holds something else;
/// FileError.
void begin_atlas(const std::string& atlas, const std::string& options, const std::vector<FleetLog>& logs);

/// The records of all logs of all lists, by path; "missing" are those that have no record or have lost their run
/// folder. Throws FileError if there is no atlas.
std::vector<FleetRecord> read_atlas(const std::string& atlas);

struct AtlasSummary {
  std::size_t logs = 0;
  std::size_t mapped = 0;
  std::size_t refused = 0;
  std::size_t failed = 0;
  std::size_t missing = 0;
  std::size_t hosts = 0;
  std::uint64_t scans = 0;
  double path_m = 0.0;
  double log_duration_s = 0.0;
  double cpu_s = 0.0;
  /// Empty while logs are failed or missing. Else over a line for each log, sorted: its hash, that of its options, its
  /// outcome, the hash of its result. So it depends on the logs' bytes, the options and the program, and not on names
  /// and order of the logs, shards, machines, instruction sets or devices.
  std::string sha256{};
};
AtlasSummary summary_of(const std::vector<FleetRecord>& records);

/// atlas.json; its atlas_sha256 is null instead of empty.
nlohmann::ordered_json atlas_json(const AtlasSummary& summary);

/// A line a log with a header; RFC 4180.
std::string summary_csv(const std::vector<FleetRecord>& records);

}  // namespace gdtslam

// The logs of a fleet command and of a shard of it. Opens no log. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace gdtslam {

/// A log to be mapped: a file, or the folder of a ROS 2 bag.
struct FleetLog {
  std::string path;  ///< absolute
  std::uint64_t bytes = 0;
  friend bool operator==(const FleetLog&, const FleetLog&) = default;
};

/// True if a file's name has the ending of a log: .log, .clf, .csv, .jsonl, .bag, .mcap or .db3, each plain or packed
/// (.gz, .bz2, .xz, .zst).
bool has_name_of_a_log(const std::filesystem::path& file);

/// The named logs and the logs in named folders, each once: the largest first, then by path. Folders are searched
/// recursively, except hidden folders, links to folders, run folders and atlases. Throws FileError for a missing path;
/// InputError for a folder without a log, and for a path that is no UTF-8 or has control characters.
std::vector<FleetLog> find_logs(const std::vector<std::string>& named);

/// One of `count` parts of the logs; parts are mapped independently.
struct Shard {
  std::size_t number = 1;  ///< from 1
  std::size_t count = 1;
};

/// "3/20". Throws UsageError.
Shard parse_shard(const std::string& text);

/// Every count-th log, so that shards have about equal sizes.
std::vector<FleetLog> logs_of_shard(const std::vector<FleetLog>& logs, const Shard& shard);

// The folder of a fleet's maps (docs/formats.md#atlas): options.txt, lists of logs, a record and a run folder for each
// log, and the results of `gdtslam fleet finish`. Thread-safe.

/// The record of a log, logs/NAME/record.json. It is written last, and it alone marks the log as done.
struct FleetRecord {
  std::string log{};                ///< its absolute path
  std::string outcome = "missing";  ///< or mapped; refused: a fault of its bytes; failed: a fault of the machine
  int exit_code = 0;
  std::string reason{};  ///< why it was not mapped, one line
  std::string run{};     ///< the run folder, below the atlas
  std::uint64_t bytes = 0;
  std::uint64_t scans = 0;
  std::uint64_t doubtful = 0;
  std::uint64_t keyframes = 0;
  double path_m = 0.0;
  double log_duration_s = 0.0;
  double width_m = 0.0;
  double height_m = 0.0;
  double cpu_s = 0.0;
  double wall_s = 0.0;
  std::string host{};
  std::string device{};
  std::string log_sha256{};      ///< hash of the file; for a folder, of its files' names and hashes
  std::string options_sha256{};  ///< hash of program and options, and of the linkage beside the log
  std::string result_sha256{};   ///< hash of the results that do not depend on the machine
  [[nodiscard]] bool is_mapped() const { return outcome == "mapped"; }
  friend bool operator==(const FleetRecord&, const FleetRecord&) = default;
};

/// Calls visit(name, value) for each field: the keys of record.json and the columns of summary.csv.
template <class Record, class Visit>
void for_each_field(Record& record, const Visit& visit) {
  visit("log", record.log);
  visit("outcome", record.outcome);
  visit("exit_code", record.exit_code);
  visit("reason", record.reason);
  visit("run", record.run);
  visit("bytes", record.bytes);
  visit("scans", record.scans);
  visit("doubtful", record.doubtful);
  visit("keyframes", record.keyframes);
  visit("path_m", record.path_m);
  visit("log_duration_s", record.log_duration_s);
  visit("width_m", record.width_m);
  visit("height_m", record.height_m);
  visit("cpu_s", record.cpu_s);
  visit("wall_s", record.wall_s);
  visit("host", record.host);
  visit("device", record.device);
  visit("log_sha256", record.log_sha256);
  visit("options_sha256", record.options_sha256);
  visit("result_sha256", record.result_sha256);
}

/// "drive.log-0123456789ab": the log's file name in plain letters and a hash of its path.
std::string name_in_atlas(const std::string& log);
/// "ATLAS/logs/NAME", the folder of the record and of the map's thumbnail.
std::string record_folder(const std::string& atlas, const std::string& log);

/// Atomic. Throws FileError.
void write_record(const std::string& atlas, const FleetRecord& record);
/// The record of a log; none if it is missing or damaged, so that the log is mapped again.
std::optional<FleetRecord> read_record(const std::string& atlas, const std::string& log);

inline constexpr const char* kOptionsFile = "options.txt";

/// Makes the folder and writes the options, which are the same for all logs of an atlas, and the list of logs. Every
/// shard calls it. Throws UsageError if the atlas has other options or the folder holds something else; FileError.
void begin_atlas(const std::string& atlas, const std::string& options, const std::vector<FleetLog>& logs);

/// The records of all logs of all lists, by path; "missing" for a log without a record or whose run folder is gone.
/// Throws FileError if there is no atlas.
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
  /// Empty if any log is failed or missing. Else the hash of one line for each log, sorted: hash of the log, hash of
  /// its options, outcome, hash of its result. So it depends on the logs' bytes, the options and the program, and not
  /// on names and order of the logs, shards, machines, instruction sets or devices.
  std::string sha256{};
};
AtlasSummary summarise_atlas(const std::vector<FleetRecord>& records);

/// atlas.json; its atlas_sha256 is null instead of empty.
nlohmann::ordered_json atlas_json(const AtlasSummary& summary);

/// A header and one line for each log; RFC 4180.
std::string summary_csv(const std::vector<FleetRecord>& records);

}  // namespace gdtslam

// The record of a log in an atlas, logs/NAME/record.json, which is written last and is the only thing that says that
// the log is done. Thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace gdtslam {

struct FleetRecord {
  std::string log{};                ///< its absolute path
  std::string outcome = "missing";  ///< or mapped; refused: its bytes are to blame; failed: the machine is
  int exit_code = 0;
  std::string reason{};  ///< why it is not mapped, one line
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
  std::string log_sha256{};      ///< of the file; of a folder, of its files' names and hashes
  std::string options_sha256{};  ///< of program and options, and of the linkage beside the log
  std::string result_sha256{};   ///< of the results that do not depend on the machine
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
/// "ATLAS/logs/NAME", where the record and the thumbnail of the map lie.
std::string record_folder(const std::string& atlas, const std::string& log);

/// Atomic. Throws FileError.
void write_record(const std::string& atlas, const FleetRecord& record);
/// Nothing if there is none, or if it is damaged: the log is mapped again then.
std::optional<FleetRecord> read_record(const std::string& atlas, const std::string& log);

}  // namespace gdtslam

// What became of a unit: units/NNN/NNNNNN.json of an atlas, written last, so that a unit with a record is done and one
// without is to do; and a shard's records in a table, so that 100,000 of them are read in a second. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// Figures of a map, from report.json.
struct UnitFigures {
  std::uint64_t scans = 0;
  std::uint64_t doubtful = 0;
  std::uint64_t keyframes = 0;
  double path_m = 0.0;
  double log_duration_s = 0.0;
  double width_m = 0.0;
  double height_m = 0.0;
  friend bool operator==(const UnitFigures&, const UnitFigures&) = default;
};

/// What tells a record's file from one that took its place later, on any node.
struct RecordStamp {
  std::uint64_t bytes = 0;
  std::int64_t written_ns = 0;
  friend bool operator==(const RecordStamp&, const RecordStamp&) = default;
};

struct UnitRecord {
  std::string plan;  ///< StoredPlan::id
  std::size_t unit = 0;
  std::string uri;
  std::uint64_t bytes = 0;    ///< that were read
  std::string input_sha256;   ///< of the log
  std::string run;            ///< name of the unit by its content, and of its run folder
  int exit_code = 0;          ///< 0: mapped; else the log was refused
  std::string reason;         ///< why, one line
  std::string result_sha256;  ///< of what must not differ between nodes; empty where refused
  UnitFigures figures;
  double cpu_s = 0.0;
  double wall_s = 0.0;
  std::string host;
  std::string isa;
  std::string device;
  RecordStamp stamp{};  ///< of the file before it was read; zeros: it comes from none
  [[nodiscard]] bool is_mapped() const { return exit_code == 0; }
  friend bool operator==(const UnitRecord&, const UnitRecord&) = default;
};

/// "units/012/012345.json".
std::string record_path(std::size_t unit);
/// "runs/ab/abcdef0123456789".
std::string run_path(const std::string& run);

std::string record_text(const UnitRecord& record);
/// Throws InputError with one line where the text is torn or no record.
UnitRecord parse_record(std::string_view text, const std::string& name);
/// Throws FileError where a pipe, a folder, or a link that leads nowhere has the name of a file of the atlas: nobody
/// could read it or write there.
void require_file_or_nothing(const std::string& file);

/// Nothing where there is no such file.
std::optional<RecordStamp> stamp_of_record(const std::string& atlas, std::size_t unit);
/// Throws InputError, FileError.
UnitRecord read_record(const std::string& atlas, std::size_t unit);
/// Atomic; nothing where the unit has a record of the same plan that still holds: of the same result, or of a run that
/// is there. Throws FileError.
void write_record(const std::string& atlas, const UnitRecord& record);

/// The table of a shard: a line a record, columns with tabs between them, and a last line with their number. Of the
/// same records the same text.
std::string records_table(const std::string& plan, const std::vector<UnitRecord>& records);
/// Nothing where it is of another plan, cut, damaged or no UTF-8: the records are there to be read one by one.
std::optional<std::vector<UnitRecord>> parse_records_table(std::string_view text, const std::string& plan);

/// What can be said about a unit in one line of a table: without tabs, line ends and other control characters.
std::string table_text(std::string_view text);

}  // namespace gdtslam

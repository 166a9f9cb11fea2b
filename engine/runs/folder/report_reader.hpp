// A JSON file of a run as text that somebody may have edited: every key is asked for by name and type, and what is
// wrong is said in one line with the file, the key and what to do. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"

namespace gdtslam {

/// A report is read up to so many bytes: of a day of scans, all of them doubtful.
inline constexpr std::size_t kMostReportBytes = std::size_t{80} << 20U;
inline constexpr const char* kReportFile = "report.json";
inline constexpr const char* kMergeFile = "merge.json";  ///< beside the sites of a merge
inline constexpr const char* kMapAgain = "; map the log again: gdtslam map LOG -o ";

/// A row of the list of a run's files.
struct ReportFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::string sha256;
};

/// An object of a report: the whole, or one within. All members throw InputError that names the file and the key, and
/// ends with the advice.
class ReportReader {
 public:
  using Value = nlohmann::ordered_json;

  ReportReader(std::string file, std::string advice, Value report);

  [[nodiscard]] std::uint64_t whole(const char* key) const;
  /// A whole number below `end`.
  [[nodiscard]] std::size_t index(const char* key, std::uint64_t end) const;
  [[nodiscard]] double number(const char* key) const;
  /// A list of so many numbers of that size at most.
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count, double most) const;
  /// A list of such lists.
  [[nodiscard]] std::vector<std::vector<double>> rows(const char* key, std::size_t count, double most) const;
  /// Returns no number for null, which stands for a value that was not measured.
  [[nodiscard]] std::optional<double> number_or_null(const char* key) const;
  [[nodiscard]] bool truth(const char* key) const;
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] GridGeometry geometry(const char* key) const;
  [[nodiscard]] std::vector<std::string> texts(const char* key) const;
  [[nodiscard]] bool has(const char* key) const;
  /// Whole numbers below `end`: entries of a list, or one member of each.
  [[nodiscard]] std::vector<std::size_t> indices(const char* key, const char* member, std::uint64_t end) const;
  /// Rows of name, bytes and SHA-256.
  [[nodiscard]] std::vector<ReportFile> files(const char* key) const;
  /// An object within this one, and a list of objects.
  [[nodiscard]] ReportReader section(const char* key) const;
  [[nodiscard]] std::vector<ReportReader> entries(const char* key) const;
  [[noreturn]] void fail(const std::string& fault) const;
  [[noreturn]] void fail(const char* key, const std::string& fault) const;

 private:
  using IsOfType = bool (*)(const Value& value);
  [[nodiscard]] const Value& at(const char* key) const;
  [[nodiscard]] const Value& at(const char* key, IsOfType is_of_type, const char* type) const;
  [[nodiscard]] const Value& list(const char* key) const;
  [[nodiscard]] std::vector<double> numbers_in(const Value& value, const char* key, std::size_t count,
                                               double most) const;
  [[nodiscard]] ReportReader within(const Value& object, const std::string& name) const;

  std::string file_;
  std::string advice_;
  std::string path_;  // path of this object within the report, with a dot at its end
  std::shared_ptr<const Value> report_;
  const Value* object_;
};

/// The report of the run in `folder`. Throws FileError; InputError if it is none of this version.
ReportReader read_report(const std::string& file, const std::string& folder);

}  // namespace gdtslam

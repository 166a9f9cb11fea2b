// Reads a JSON file of a run that somebody may have edited: each key by name and type. A fault is reported in one line
// with the file, the key and what to do. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/files/file_state.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/grid_geometry.hpp"

namespace gdtslam {

/// Limit on the size of a report: a day of scans, all of them doubtful.
inline constexpr std::size_t kMostReportBytes = std::size_t{80} << 20U;
inline constexpr const char* kReportFile = "report.json";
inline constexpr const char* kMergeFile = "merge.json";  ///< in the folder with the sites of a merge
inline constexpr const char* kMapAgain = "; map the log again: gdtslam map LOG -o ";

/// A row of the list of a run's files.
struct ReportFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::string sha256;
};

/// An object of a report: the whole report or a section. All members throw InputError with the file, the key and the
/// advice.
class ReportReader {
 public:
  using Value = nlohmann::ordered_json;

  ReportReader(std::string file, std::string advice, Value report);

  [[nodiscard]] std::uint64_t whole(const char* key) const;
  /// A whole number below `end`.
  [[nodiscard]] std::size_t index(const char* key, std::uint64_t end) const;
  [[nodiscard]] double number(const char* key) const;
  /// A list of `count` numbers of magnitude at most `most`.
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
  /// Whole numbers below `end`: the entries of a list, or one member of each entry.
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
  std::string path_;  // path of this object within the report, with a dot at the end
  std::shared_ptr<const Value> report_;
  const Value* object_;
};

/// The report of the run in `folder`. Throws FileError; InputError if it is not a report of this version.
ReportReader read_report(const std::string& file, const std::string& folder);

// The files of a run as its report lists them: name, size and SHA-256 of each. A file is compared with the list before
// it is read, and afterwards the run must still be the same one. So all data are of one run, even if it is replaced
// meanwhile. A file is hashed once. Reports of older versions have no list: their files are not checked. Thread-safe.

/// `files` of report.json: name, bytes and SHA-256 of each staged file, sorted by name. Leaves out folders: tiles can
/// be made again without a run, and have hashes of their own. Throws FileError.
nlohmann::ordered_json files_json(const RunFolder& folder);

class RunFiles {
 public:
  /// Reads the list and passes the report to `also`. Throws InputError if the folder is no finished run, or its report
  /// cannot be used; FileError.
  explicit RunFiles(std::string folder, const std::function<void(const ReportReader&)>& also = {});

  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] std::string path(const std::string& name) const;
  /// False if the report is of an older version without a list of files.
  [[nodiscard]] bool is_told() const { return told_.has_value(); }
  /// True if the run has such a file: by the report, or in the folder if the report has no list.
  [[nodiscard]] bool has(const std::string& name) const;
  /// Compares the file with the report and returns its path. Throws InputError if they differ or there is no file.
  [[nodiscard]] std::string checked(const std::string& name) const;
  /// Throws InputError if the run was replaced.
  void expect_unchanged() const;
  /// The report once more. Throws like expect_unchanged().
  [[nodiscard]] ReportReader report() const;

  /// Returns the result of `read` for the checked file.
  template <class Read>
  auto read(const std::string& name, const Read& read) const {
    const std::string file = checked(name);
    return unless_changed([&] { return read(file); });
  }
  /// Returns the result of `read`. Throws if the run was changed meanwhile, even if reading failed for another reason.
  template <class Read>
  auto unless_changed(const Read& read) const {
    try {
      auto result = read();
      expect_unchanged();
      return result;
    } catch (const Error&) {
      expect_unchanged();
      throw;
    }
  }

 private:
  /// The files that were checked, with their state then. Copies of a RunFiles share them.
  struct Checked {
    std::mutex mutex;
    std::map<std::string, FileState> states;
  };
  [[nodiscard]] bool is_checked(const std::string& name, const FileState& state) const;
  [[noreturn]] void refuse(const std::string& name, const std::string& fault) const;

  std::string folder_;
  std::optional<FileState> report_state_;
  std::optional<std::map<std::string, ReportFile>> told_;
  std::shared_ptr<Checked> checked_ = std::make_shared<Checked>();
};

/// Throws InputError if the folder has the sites of a merge; the message suggests one of them.
void refuse_folder_of_sites(const std::string& folder);

/// The run in the folder, if its report lists its files.
std::optional<RunFiles> told_files_in(const std::string& folder);

}  // namespace gdtslam

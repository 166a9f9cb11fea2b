// A JSON file of a run as text that somebody may have edited: every key is asked for by name and type, and what is
// wrong is said in one line with the file, the key and what to do. Thread-safe.
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

// The files of a run as its report names them: name, size and SHA-256 of each. A file is read after its bytes were
// compared with that, and then the run must still be the same one: so all that is read is of one run, also if it is
// replaced meanwhile. A file is hashed once. Reports of older versions have no such list: their files are taken as they
// are. Several threads may ask one object at once.

/// `files` of report.json: rows of name, bytes and SHA-256, sorted by name, of all that is staged. Folders are left
/// out: tiles are made again without a run, and have hashes of their own. Throws FileError.
nlohmann::ordered_json files_json(const RunFolder& folder);

class RunFiles {
 public:
  /// Reads the list. Throws InputError where the folder is no finished run, or its report cannot be used; FileError.
  /// `also` gets the report that the list is of.
  explicit RunFiles(std::string folder, const std::function<void(const ReportReader&)>& also = {});

  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] std::string path(const std::string& name) const;
  /// False where the report is of a version that told of no files.
  [[nodiscard]] bool is_told() const { return told_.has_value(); }
  /// Whether the run has such a file: what the report tells; what lies there, where it tells of none.
  [[nodiscard]] bool has(const std::string& name) const;
  /// Path of the file, whose bytes are compared with the report. Throws InputError if they are others or there
  /// is none.
  [[nodiscard]] std::string checked(const std::string& name) const;
  /// Throws InputError if the run was replaced.
  void expect_unchanged() const;
  /// The report once more. Throws what expect_unchanged() throws.
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
  /// The files that were checked, as they were then. Copies of a RunFiles share them.
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

/// Throws InputError where the folder has the sites of a merge, with one of them to give.
void refuse_folder_of_sites(const std::string& folder);

/// The run there, where its report tells of its files.
std::optional<RunFiles> told_files_in(const std::string& folder);

}  // namespace gdtslam

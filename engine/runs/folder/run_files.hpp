// The files of a run as its report names them: name, size and SHA-256 of each. A file is read after its bytes were
// compared with that, and then the run must still be the same one: so all that is read is of one run, also if it is
// replaced meanwhile. A file is hashed once. Reports of older versions have no such list: their files are taken as they
// are. Several threads may ask one object at once.
#pragma once

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
#include "engine/runs/folder/report_reader.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

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

// The files of a run as its report tells of them: name, size and SHA-256 of each. Whoever reads a run reads a file only
// after its bytes were held against that, and asks afterwards whether it is that file still; so what is read is of one
// run, whoever changes or replaces files meanwhile. A file is hashed once. Reports of versions before have no such
// list: their files are taken as they are. Several threads may ask one object at once.
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
  /// All that the report tells of, sorted.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Where the file is, which has the bytes that the report tells of. Throws InputError where they are others or there
  /// is none.
  [[nodiscard]] std::string checked(const std::string& name) const;
  /// Of a checked file. Throws what checked() throws.
  [[nodiscard]] std::string sha256(const std::string& name) const;
  /// Throws InputError where the report or a file that was checked is another by now.
  void expect_unchanged() const;
  /// The report once more. Throws InputError where it is another by now.
  [[nodiscard]] ReportReader report() const;

  /// What `read` makes of the checked file.
  template <class Read>
  auto read(const std::string& name, const Read& read) const {
    const std::string file = checked(name);
    return unless_changed([&] { return read(file); });
  }
  /// What `read` gives. Where something was changed meanwhile, that is said, whatever became of reading.
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
  struct Told {
    std::uint64_t bytes = 0;
    std::string sha256;
  };
  /// The files that were checked, as they were then. Copies of a RunFiles share them.
  struct Seen {
    std::mutex mutex;
    std::map<std::string, FileState> states;
  };
  [[nodiscard]] bool is_seen(const std::string& name, const FileState& state) const;
  void note(const std::string& name, const FileState& state) const;
  [[nodiscard]] std::optional<FileState> state_of(const std::string& name) const;
  void check_bytes(const std::string& name, const Told& told, const FileState& state) const;
  [[noreturn]] void refuse(const std::string& name, const std::string& fault) const;

  std::string folder_;
  std::optional<std::map<std::string, Told>> told_;
  std::shared_ptr<Seen> seen_ = std::make_shared<Seen>();
};

/// Throws InputError where the folder has the sites of a merge, with one of them to give.
void refuse_folder_of_sites(const std::string& folder);

/// The run there, where its report tells of its files.
std::optional<RunFiles> told_files_in(const std::string& folder);

}  // namespace gdtslam

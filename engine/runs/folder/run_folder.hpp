// The folder that a run, a merge or an edit writes to. It takes its name as a whole (FolderTransaction), so it holds
// the files of one run and nothing else. A folder that holds anything that no run wrote is refused. One object belongs
// to one thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/transaction/folder_transaction.hpp"

namespace gdtslam {

class RunFolder {
 public:
  /// `replaces_files`: files in the folder that no run wrote are removed with the old run; folders never are. Throws
  /// what FolderTransaction throws, and UsageError if the folder holds anything else that no run wrote.
  explicit RunFolder(const std::string& path, bool replaces_files = false);

  /// Path for writing the file of that name until commit().
  std::string staged(std::string_view name);
  /// Path for writing the files of a folder of that name, which is made.
  std::string staged_folder(std::string_view name);
  [[nodiscard]] std::string staged_path(std::string_view name) const;
  /// The run fails, and this staged log cannot be had again: it stays beside the folder. Returns its path. Throws
  /// FileError.
  [[nodiscard]] std::string keep_log(const std::string& name);
  /// Logs of streams that a killed process left, kept in the same way.
  [[nodiscard]] const std::vector<std::string>& left_logs() const { return left_logs_; }
  /// Throws what FolderTransaction::commit() throws, and UsageError if something came into the folder meanwhile that
  /// may not be replaced.
  void commit();

  /// Names of all that is staged, in the order in which they were asked for.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// The file's name once it is committed.
  [[nodiscard]] std::string file(std::string_view name) const;

 private:
  void require_replaceable() const;
  void keep_logs(const std::filesystem::path& left);

  std::string path_;
  bool replaces_files_;
  std::vector<std::string> left_logs_;
  std::vector<std::string> names_;
  FolderTransaction transaction_;
};

/// "log-1.jsonl.zst": the log that a run keeps of a pipe, counted from 0.
std::string kept_log_name(std::size_t log);
bool is_kept_log(std::string_view name);

/// "session-1.tum": the path of a site's first run, counted from 0. Every site of a merge has it, and no run of `map`.
std::string session_file_name(std::size_t run);

/// Whether a run, a merge or an edit writes files of that name.
bool is_file_of_a_run(std::string_view name);

/// Whether a merge wrote that folder as a site: it has the paths of its drives, and was not edited since. A link to one
/// is none.
bool is_site(const std::string& folder);

/// runs/<name of the log>-<UTC time>, made unique with a number where it exists.
std::string default_run_folder(const std::string& log);

/// Points the link `latest` beside the folder to it, atomically. A file or folder of that name is left alone. Throws
/// FileError.
void link_latest(const std::string& run_folder);

/// The file's path with every link and `..` resolved; of what is not there yet, where it would be made.
std::filesystem::path place_of_file(const std::string& file);

/// Whether `file` lies in the folder, or in one inside it.
bool lies_in(const std::string& folder, const std::string& file);

/// Whether `file` is, or would be, one that a run of this program writes into `folder`.
bool is_run_file_in(const std::string& folder, const std::string& file);

// Map and path so far of a `gdtslam live` run that is not finished, in the folder `snapshot` of the
// run's. It bears no mark, so it is known by what lies in it: its files, all of them, and nothing else.

inline constexpr const char* kSnapshotFolder = "snapshot";
inline constexpr const char* kSnapshotMap = "map.yaml";
inline constexpr const char* kSnapshotTrajectory = "trajectory.tum";

/// Whether that is a snapshot, which may be replaced and removed. A link to one is none.
bool is_snapshot(const std::string& folder);

/// Removes the files of a snapshot, and the folder if nothing else lies in it.
void remove_snapshot(const std::string& folder);

/// Throws UsageError where something else has the name of the run folder's snapshot.
void require_no_foreign_snapshot(const std::string& run_folder);

}  // namespace gdtslam

// The folder that a run, a merge or an edit writes to. It is renamed into place as a whole (FolderTransaction), so it
// holds the files of one run and nothing else. A folder with foreign files is refused. One object belongs to one
// thread.
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
  /// `replaces_files`: foreign files in the folder are removed with the old run; foreign folders never are. Throws like
  /// FolderTransaction, and UsageError if the folder holds anything else that no run wrote.
  explicit RunFolder(const std::string& path, bool replaces_files = false);

  /// Path for writing the file of that name until commit().
  std::string staged(std::string_view name);
  /// Makes a folder of that name for files until commit(), and returns its path.
  std::string staged_folder(std::string_view name);
  [[nodiscard]] std::string staged_path(std::string_view name) const;
  /// For a run that fails: keeps this staged log, which nobody can read again, beside the folder. Returns its path.
  /// Throws FileError.
  [[nodiscard]] std::string keep_log(const std::string& name);
  /// Logs of streams that a killed process left; they are kept in the same way.
  [[nodiscard]] const std::vector<std::string>& left_logs() const { return left_logs_; }
  /// Throws like FolderTransaction::commit(), and UsageError if the folder meanwhile got something that may not be
  /// replaced.
  void commit();

  /// Names of all staged files and folders, in the order of the calls.
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

/// "log-1.jsonl.zst": the copy of a pipe that a run keeps; `log` counts from 0.
std::string kept_log_name(std::size_t log);
bool is_kept_log(std::string_view name);

/// "session-1.tum": the path of a run of a site; `run` counts from 0. Every site of a merge has it, and no run of
/// `map`.
std::string session_file_name(std::size_t run);

/// Whether a run, a merge or an edit writes files of that name.
bool is_file_of_a_run(std::string_view name);

/// True for a site of a merge that was not edited since: it has the paths of its drives. False for a link to one.
bool is_site(const std::string& folder);

/// runs/<name of the log>-<UTC time>, made unique with a number if it exists.
std::string default_run_folder(const std::string& log);

/// Makes the link `latest` beside the folder point to it, atomically. A file or folder of that name is left alone.
/// Throws FileError.
void link_latest(const std::string& run_folder);

/// The file's path with every link and `..` resolved; for a missing file, where it would be made.
std::filesystem::path place_of_file(const std::string& file);

/// Whether `file` lies in the folder, or in one inside it.
bool lies_in(const std::string& folder, const std::string& file);

/// True if a run of this program writes `file` into `folder`, whether it exists or not.
bool is_run_file_in(const std::string& folder, const std::string& file);

// A snapshot: map and path so far of an unfinished `gdtslam live` run, in the subfolder `snapshot` of its folder. It
// has no mark, so a snapshot is a folder with all of its files and nothing else.

inline constexpr const char* kSnapshotFolder = "snapshot";
inline constexpr const char* kSnapshotMap = "map.yaml";
inline constexpr const char* kSnapshotTrajectory = "trajectory.tum";

/// True for a snapshot, which may be replaced and removed. False for a link to one.
bool is_snapshot(const std::string& folder);

/// Removes the files of a snapshot, and the folder if it is then empty.
void remove_snapshot(const std::string& folder);

/// Throws UsageError if something else has the name of the run folder's snapshot.
void require_no_foreign_snapshot(const std::string& run_folder);

}  // namespace gdtslam

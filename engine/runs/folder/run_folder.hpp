// The folder that a run writes to. All files are written and synced in a staging folder inside it first. The commit
// takes the old files away, the last of the list first, and then gives the new ones their names in the order in which
// they were asked for. So a run that fails, whatever the reason, leaves the old files as they were, byte for byte; and
// where the process is killed in the middle of the commit, old and new files never lie beside each other and the last
// file of the list, which tells of the others, is missing. Nobody else writes to the folder as long as the object
// lives. One object belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/folder/folder_lock.hpp"

namespace gdtslam {

/// How the names of staging folders begin; the number of the process follows.
inline constexpr std::string_view kStagingPrefix = ".gdtslam-staging-";

/// The old files in a staging folder, from the commit on. No file of a run or of its user that is staged has a name
/// that begins with a dot.
inline constexpr std::string_view kOldFiles = ".old";

/// What becomes of files that have the name of one that a run writes or takes away, and are of nobody knows whom.
enum class ForeignFiles : std::uint8_t {
  kKept,  ///< nothing is committed where one is in the way
  kReplaced,
};

class RunFolder {
 public:
  /// What becomes of what killed processes left in the folder, as the only copy of a log, when all has its name.
  enum class Leftovers { kRemoved, kKept };
  /// Makes the folder if need be, and the staging folder, so that a place that cannot be written shows before the work
  /// is done. Throws FileError, as commit() does; UsageError where somebody writes to the folder.
  explicit RunFolder(const std::string& path, ForeignFiles foreign = ForeignFiles::kKept);
  /// Takes over what a killed run left in that folder, its staging folder. Throws likewise.
  RunFolder(const std::string& path, const std::filesystem::path& leftover, ForeignFiles foreign = ForeignFiles::kKept);
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  /// Removes what is staged, and the folder itself where this object made it and nothing came into it. What was taken
  /// over stays, so that the run can be gone on with once more.
  ~RunFolder();

  /// The run will fail, and cannot be made again: of what is staged these files stay, as those of a killed run do.
  void keep(std::span<const std::string> names);

  /// The staging folders of killed processes.
  [[nodiscard]] std::vector<std::filesystem::path> leftovers() const;
  /// Before the commit, but for what is left of another one, which goes with this one.
  void remove_leftovers() const;

  /// Where to write the file of that name until commit().
  std::string staged(std::string_view name);
  /// Where to write the files of a folder of that name, which is made.
  std::string staged_folder(std::string_view name);
  /// Where that file is until then, without that it becomes one of the run.
  [[nodiscard]] std::string staged_path(std::string_view name) const { return (staging_ / name).string(); }
  /// Where the old files are after commit(), until they go with the object.
  [[nodiscard]] std::string old_files() const { return (staging_ / kOldFiles).string(); }
  /// What lies there goes with the object, but for what is staged.
  [[nodiscard]] std::string staging() const { return staging_.string(); }
  /// This run makes no such file: one that an earlier run left goes with commit().
  void without(std::string_view name) { gone_.emplace_back(name); }
  /// Every staged file takes its name; with a report of a run they take the place of the run that lies there. Throws
  /// UsageError where a name is one of a file of somebody else.
  void commit(Leftovers leftovers = Leftovers::kRemoved);

  /// Of all that is staged, in the order in which they were asked for.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] std::string path() const { return folder_.string(); }
  /// The file's name once it is committed.
  [[nodiscard]] std::string file(std::string_view name) const { return (folder_ / name).string(); }

 private:
  void move(const std::filesystem::path& from, const std::filesystem::path& to, const std::string& name) const;
  std::vector<std::string> replaced_names();
  void replace(const std::vector<std::string>& old_names);
  [[nodiscard]] std::string put_back(const std::vector<std::string>& old_names) const;
  /// In the handler of what ended the commit, which is thrown again with what cannot be undone.
  [[noreturn]] void undo(const std::vector<std::string>& old_names);

  /// Makes the folder, and those that it lies in; gone with the object where they were not there before and nothing
  /// came into them.
  class MadeFolder {
   public:
    explicit MadeFolder(const std::filesystem::path& path);
    MadeFolder(const MadeFolder&) = delete;
    MadeFolder& operator=(const MadeFolder&) = delete;
    ~MadeFolder();

   private:
    std::vector<std::filesystem::path> made_;  ///< with those that it lies in, the innermost first
  };

  std::filesystem::path folder_;
  std::optional<MadeFolder> made_;  ///< nothing where the folder was taken over
  std::filesystem::path staging_;
  std::optional<FolderLock> lock_;
  ForeignFiles foreign_ = ForeignFiles::kKept;
  std::vector<std::string> names_;
  std::vector<std::string> gone_;
  std::size_t given_ = 0;  ///< of names_, in the commit
  bool stays_ = false;     ///< what is staged, whatever becomes of the object
  bool holds_only_copy_ =
      false;  ///< the staging folder, of old files: while a commit lasts, or where it cannot be undone
};

/// Removes what runs that ended left in the folder, as one whose own staging folder could not be removed. Throws
/// FileError.
void remove_stagings_of_ended_runs(const std::string& folder);

/// What a killed run left.
struct UnfinishedRun {
  std::filesystem::path folder;  ///< its staging folder; empty: there is none
  bool is_of_a_commit = false;   ///< some of its files have their names already
};
/// The newest in the folder that has that file, or was killed as its files got their names. Throws UsageError where a
/// process that writes there lives.
UnfinishedRun unfinished_run_in(const std::string& folder, const char* file);

/// Nothing where the folder holds no file that a run would replace or remove, nor one of the names given, or where a
/// run of this program wrote them, by what its report tells. Throws UsageError else, so that nobody loses a map.yaml or
/// a linkage.yaml of another origin; FileError.
void require_no_foreign_files(const std::string& folder, std::span<const std::string> besides = {});

/// Whether a run, a merge or an edit writes files of that name.
bool is_file_of_a_run(std::string_view name);

/// runs/<name of the log>-<UTC time>, made unique with a number where it exists.
std::string default_run_folder(const std::string& log);

/// Points the link `latest` beside the folder to it, atomically. A file or folder of that name is left alone. Throws
/// FileError.
void link_latest(const std::string& run_folder);

}  // namespace gdtslam

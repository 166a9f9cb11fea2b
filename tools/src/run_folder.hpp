// The folder that a run writes to. All files are written and synced in a staging folder inside it first and then
// renamed to their names in the order in which they were asked for, so that a run that fails, whatever the reason,
// leaves the folder's old files as they were, byte for byte. One object belongs to one thread.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

class RunFolder {
 public:
  /// Makes the folder if need be, and the staging folder, so that a place that cannot be written shows before the work
  /// is done. Throws FileError, as commit() does.
  explicit RunFolder(const std::string& path);
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  /// Removes what is staged, and the folder itself where this object made it and nothing came into it.
  ~RunFolder();

  /// Where to write the file of that name until commit().
  std::string staged(std::string_view name);
  /// This run makes no such file: one that an earlier run left goes with commit().
  void without(std::string_view name) { gone_.emplace_back(name); }
  /// Every staged file takes its name.
  void commit();

  [[nodiscard]] std::string path() const { return folder_.string(); }
  /// The file's name once it is committed.
  [[nodiscard]] std::string file(std::string_view name) const { return (folder_ / name).string(); }

 private:
  /// Tells which files of these names there were.
  [[nodiscard]] std::vector<bool> keep_old(const std::filesystem::path& kept,
                                           const std::vector<std::string>& names) const;
  [[nodiscard]] std::string put_back(const std::filesystem::path& kept, const std::vector<std::string>& names,
                                     const std::vector<bool>& existed) const;

  std::filesystem::path folder_;
  std::filesystem::path staging_;
  std::vector<std::string> names_;
  std::vector<std::string> gone_;
  bool is_new_ = false;
};

/// runs/<name of the log>-<UTC time>, made unique with a number where it exists.
std::string default_run_folder(const std::string& log);

/// Points the link `latest` beside the folder to it, atomically. A file or folder of that name is left alone. Throws
/// FileError.
void link_latest(const std::string& run_folder);

}  // namespace gdtslam

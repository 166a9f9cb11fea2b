// Folders of the command: its assets (scenes, the sample log, expected results), its cache, and temporary folders.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// Existing folders of that kind ("scenes", "logs", "expected"), best first: beside an installed command
/// (share/gdtslam), else in the source tree of the build.
std::vector<std::string> asset_folders(std::string_view kind);

/// A file in one of them. Throws FileError that lists the folders.
std::string asset_file(std::string_view kind, const std::string& name);

/// The sample log that comes with the command. Throws FileError.
std::string sample_log_file();
/// The sample log of a nodding laser; its linkage is beside it. Throws FileError.
std::string nodding_sample_log_file();

/// A new folder below another one, else $TMPDIR or /tmp. The destructor removes it with its content.
class TemporaryFolder {
 public:
  /// Throws FileError.
  explicit TemporaryFolder(const std::string& name, std::string below = "");
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The folder for files that can be made again: the driver's pipelines and the results of `gdtslam verify`.
struct CacheFolder {
  std::string path;     ///< empty if there is none
  std::string problem;  ///< why there is none
};

/// $XDG_CACHE_HOME/gdtslam, else ~/.cache/gdtslam; created with access for this user alone. A missing home is not
/// created: an account without one must leave nothing behind.
CacheFolder cache_folder();

}  // namespace gdtslam

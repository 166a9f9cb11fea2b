// Folders of the command: of the files that come with it (scenes, the sample log, the results that it must give), of
// what it may lose, and for the time of a run.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// The folders of that kind ("scenes", "logs", "expected") that exist, best first: beside an installed command
/// (share/gdtslam), else in the source tree that it was built in.
std::vector<std::string> asset_folders(std::string_view kind);

/// A file in one of them. Throws FileError that names the folders.
std::string asset_file(std::string_view kind, const std::string& name);

/// The sample log that comes with the command. Throws FileError.
std::string sample_log_file();
/// That of a laser that nods; its linkage lies beside it. Throws likewise.
std::string nodding_sample_log_file();

/// A folder of its own below another one, else $TMPDIR or /tmp, that is gone with its object, with all that is in it.
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

/// The folder for files that the command may lose: the pipelines that a driver built and the results of `gdtslam
/// verify`.
struct CacheFolder {
  std::string path;     ///< empty where there is none
  std::string problem;  ///< why there is none
};

/// $XDG_CACHE_HOME/gdtslam, else ~/.cache/gdtslam, made with access for this user alone where it is missing. A home
/// that does not exist is not made: an account without one shall leave nothing behind.
CacheFolder cache_folder();

}  // namespace gdtslam

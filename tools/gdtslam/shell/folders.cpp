#include "folders.hpp"

#include <sys/stat.h>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "engine/core/files/retried.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

// Levels between a program in a build folder and the source tree.
constexpr int kLevels = 4;

std::vector<fs::path> candidates(std::string_view kind) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  const fs::path folder = program.parent_path();
  std::vector<fs::path> list{folder.parent_path() / "share" / "gdtslam" / kind};
  fs::path above = folder;
  for (int level = 0; level < kLevels; ++level) {
    above = above.parent_path();
    list.push_back(above / "assets" / kind);
  }
  return list;
}

// A path that is not absolute is ignored, by the XDG specification.
fs::path absolute_from(const char* variable) {
  const char* const value = std::getenv(variable);
  if (value == nullptr || !fs::path(value).is_absolute()) return {};
  return value;
}

fs::path base_folder() {
  fs::path named = absolute_from("XDG_CACHE_HOME");
  if (!named.empty()) return named;
  const fs::path home = absolute_from("HOME");
  std::error_code ignored;  // an error means that there is no home
  return fs::is_directory(home, ignored) ? home / ".cache" : fs::path();
}

// Creates the folder, and its parents with the same access. Returns the problem; empty if there is none.
std::string problem_of_making(const fs::path& folder) {
  if (::mkdir(folder.c_str(), S_IRWXU) == 0 || fs::is_directory(folder)) return {};
  if (errno == ENOENT && folder.has_relative_path()) {
    std::string above = problem_of_making(folder.parent_path());
    if (!above.empty()) return above;
    if (::mkdir(folder.c_str(), S_IRWXU) == 0 || fs::is_directory(folder)) return {};
  }
  return folder.string() + ": cannot be made: " + errno_text(errno);
}

}  // namespace

std::vector<std::string> asset_folders(std::string_view kind) {
  std::vector<std::string> folders;
  for (const fs::path& candidate : candidates(kind)) {
    if (fs::is_directory(candidate)) folders.push_back(candidate.string());
  }
  return folders;
}

std::string asset_file(std::string_view kind, const std::string& name) {
  std::string looked_in;
  for (const fs::path& candidate : candidates(kind)) {
    if (fs::is_regular_file(candidate / name)) return (candidate / name).string();
    looked_in += (looked_in.empty() ? "" : ", ") + candidate.string();
  }
  throw FileError(name, "comes with gdtslam but is in none of " + looked_in + "; install the command as a whole");
}

std::string sample_log_file() { return asset_file("logs", "office-start.log.gz"); }

std::string nodding_sample_log_file() { return asset_file("logs", "nodding-start.log.gz"); }

TemporaryFolder::TemporaryFolder(const std::string& name, std::string below) {
  const char* const variable = std::getenv("TMPDIR");
  if (below.empty()) below = variable != nullptr && *variable != '\0' ? variable : "/tmp";
  path_ = below + "/" + name + "-XXXXXX";
  if (::mkdtemp(path_.data()) == nullptr) throw FileError(path_, "cannot be created: " + errno_text(errno));
}

TemporaryFolder::~TemporaryFolder() {
  without_throwing([this] {
    std::error_code ignored;  // the system removes the remainder
    fs::remove_all(path_, ignored);
  });
}

CacheFolder cache_folder() {
  const fs::path base = base_folder();
  if (base.empty()) return {"", "XDG_CACHE_HOME is not set, and HOME names no folder that exists"};
  const fs::path folder = base / "gdtslam";
  std::string problem = problem_of_making(folder);
  if (!problem.empty()) return {"", std::move(problem)};
  return {folder.string(), ""};
}

}  // namespace gdtslam

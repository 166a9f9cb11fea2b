#include "asset_folder.hpp"

#include <filesystem>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

// A program in a build folder stands some levels below the source tree.
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

}  // namespace gdtslam

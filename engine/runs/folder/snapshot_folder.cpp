#include "snapshot_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "engine/core/files/folder_calls.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kSnapshotFiles{kSnapshotMap, "map.pgm", kSnapshotTrajectory};

bool is_file_of_a_snapshot(const fs::path& path) {
  const std::string name = path.filename().string();
  std::error_code ignored;
  return std::find(kSnapshotFiles.begin(), kSnapshotFiles.end(), name) != kSnapshotFiles.end() &&
         fs::is_regular_file(fs::symlink_status(path, ignored));
}

}  // namespace

// What cannot be listed is taken for somebody else's.
bool is_snapshot(const std::string& folder) {
  std::error_code failed;
  if (!fs::is_directory(fs::symlink_status(folder, failed))) return false;
  const std::vector<fs::path> files = list_folder(folder, failed);
  return !failed && files.size() == kSnapshotFiles.size() &&
         std::all_of(files.begin(), files.end(), is_file_of_a_snapshot);
}

void remove_snapshot(const std::string& folder) {
  std::error_code ignored;
  for (const std::string_view name : kSnapshotFiles) fs::remove(fs::path(folder) / name, ignored);
  fs::remove(folder, ignored);
}

void require_no_foreign_snapshot(const std::string& run_folder) {
  const std::string folder = (fs::path(run_folder) / kSnapshotFolder).string();
  std::error_code ignored;  // what cannot be asked about cannot be replaced either
  if (!fs::exists(fs::symlink_status(folder, ignored)) || is_snapshot(folder)) return;
  throw UsageError(fmt::format(
      "--output: '{}' is no snapshot of a drive, and one would have its name; give another folder", folder));
}

}  // namespace gdtslam

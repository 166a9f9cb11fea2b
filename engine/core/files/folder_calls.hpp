// Listing of folders. Thread-safe.
#pragma once

#include <filesystem>
#include <system_error>
#include <vector>

namespace gdtslam {

/// True if a file, a folder or a link has this name, even if the link is broken.
inline bool lies_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(path, ignored));
}

/// Paths of the entries of a folder, in no particular order. If `failed` is set, the list is incomplete.
inline std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder, std::error_code& failed) {
  std::vector<std::filesystem::path> paths;
  std::filesystem::directory_iterator entry(folder, failed);
  while (!failed && entry != std::filesystem::directory_iterator()) {
    paths.push_back(entry->path());
    entry.increment(failed);
  }
  return paths;
}

}  // namespace gdtslam

// Folders listed and removed by the calls of the system. The iterators of the standard library take an interruption for
// a failure, and end the process where memory is short in the middle of a listing. Linux.
#pragma once

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "engine/core/files/retried.hpp"

namespace gdtslam {

/// A folder that is read; closed with the object.
class OpenFolder {
 public:
  /// `folder` is AT_FDCWD or an open folder that the name is looked for in; a link is no folder where `is_own`.
  OpenFolder(int folder, const char* name, bool is_own, std::error_code& failed) noexcept {
    const int flags = O_RDONLY | O_DIRECTORY | O_CLOEXEC | (is_own ? O_NOFOLLOW : 0);
    const int descriptor = retried([&] { return ::openat(folder, name, flags); });
    if (descriptor >= 0) listing_ = ::fdopendir(descriptor);
    if (listing_ != nullptr) return;
    failed.assign(errno, std::generic_category());
    if (descriptor >= 0) ::close(descriptor);
  }
  OpenFolder(const OpenFolder&) = delete;
  OpenFolder& operator=(const OpenFolder&) = delete;
  ~OpenFolder() {
    if (listing_ != nullptr) ::closedir(listing_);
  }
  [[nodiscard]] int descriptor() const noexcept { return ::dirfd(listing_); }
  /// The next name, valid until the one after it; nullptr at the end, or where `failed` tells why.
  const char* next(std::error_code& failed) noexcept {
    while (listing_ != nullptr) {
      errno = 0;
      const dirent* const entry = ::readdir(listing_);
      if (entry == nullptr && errno != 0) failed.assign(errno, std::generic_category());
      if (entry == nullptr) return nullptr;
      const char* const name = static_cast<const char*>(entry->d_name);
      if (std::string_view(name) != "." && std::string_view(name) != "..") return name;
    }
    return nullptr;
  }

 private:
  DIR* listing_ = nullptr;
};

/// A file, a folder or a link, wherever it leads to. What cannot be asked about shows when it is to be replaced.
inline bool lies_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(path, ignored));
}

/// The paths of what lies in a folder, in no order. `failed` tells why it cannot be listed; what is returned then is
/// not all.
inline std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder, std::error_code& failed) {
  failed.clear();
  std::vector<std::filesystem::path> paths;
  OpenFolder open(AT_FDCWD, folder.c_str(), false, failed);
  while (const char* const name = open.next(failed)) paths.push_back(folder / name);
  return paths;
}

/// remove_tree() of a name in an open folder. The first failure is told of, and what can be removed is.
// NOLINTNEXTLINE(misc-no-recursion): as deep as folders lie in folders
inline void remove_entry(int folder, const char* name, std::error_code& failed) noexcept {
  if (retried([&] { return ::unlinkat(folder, name, 0); }) == 0 || errno == ENOENT) return;
  std::error_code first(errno, std::generic_category());
  if (first == std::errc::is_a_directory || first == std::errc::operation_not_permitted) {
    std::error_code inside;
    {
      OpenFolder open(folder, name, true, inside);
      while (const char* const entry = open.next(inside)) remove_entry(open.descriptor(), entry, inside);
    }
    if (retried([&] { return ::unlinkat(folder, name, AT_REMOVEDIR); }) == 0) return;
    if (!inside) first.assign(errno, std::generic_category());
    if (inside && inside != std::errc::not_a_directory) first = inside;
  }
  if (!failed) failed = first;
}

/// A file, or a folder with all that is in it; links are not followed. Nothing where there is none. `failed` tells of
/// what cannot be removed; what can be is gone then.
inline void remove_tree(const std::filesystem::path& path, std::error_code& failed) noexcept {
  failed.clear();
  remove_entry(AT_FDCWD, path.c_str(), failed);
}

}  // namespace gdtslam

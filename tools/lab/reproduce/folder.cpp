#include "folder.hpp"

#include <fcntl.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "engine/io/atomic_file.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::reproduce {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = "/.gdtslam-reproduce";

void rename(const std::string& from, const std::string& to) {
  std::error_code failed;
  fs::rename(from, to, failed);
  if (failed) throw FileError(to, "cannot be written: " + failed.message());
}

}  // namespace

bool is_marked_folder(const std::string& path) {
  std::error_code ignored;  // what cannot be looked at has no mark
  return fs::is_directory(fs::symlink_status(path, ignored)) && fs::is_regular_file(path + kMark, ignored);
}

void require_own_folder(const std::string& path) {
  std::error_code failed;
  const fs::file_status status = fs::symlink_status(path, failed);
  if (!fs::exists(status) || is_marked_folder(path)) return;
  if (fs::is_directory(status) && fs::is_empty(path, failed)) return;
  throw FileError(path, "was not made by gdtslam reproduce and is left alone; move it away, or give another -o DIR");
}

void make_marked_folder(const std::string& path) {
  remove_own_folder(path);
  make_folder(path);
  std::ofstream mark(path + kMark);  // in one step: whoever is killed here leaves an empty folder or one with the mark
  mark << "gdtslam reproduce made this folder and removes it again.\n" << std::flush;
  if (!mark) throw FileError(path, "cannot be written to: " + std::generic_category().message(errno));
}

void remove_own_folder(const std::string& path) {
  require_own_folder(path);
  std::error_code failed;
  fs::remove_all(path, failed);
  if (failed) throw FileError(path, "cannot be removed: " + failed.message());
}

void replace_own_folder(const std::string& from, const std::string& to) {
  require_own_folder(to);
  std::error_code failed;
  if (!fs::exists(to, failed)) return rename(from, to);
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_EXCHANGE) == 0) return remove_own_folder(from);
  if (errno != EINVAL && errno != ENOSYS)
    throw FileError(to, "cannot be written: " + std::generic_category().message(errno));
  const std::string old = to + ".old";  // a file system that exchanges no names: for a moment only this is there
  remove_own_folder(old);
  rename(to, old);
  try {
    rename(from, to);
  } catch (const FileError&) {
    fs::rename(old, to, failed);
    throw;
  }
  remove_own_folder(old);
}

}  // namespace gdtslam::reproduce

#include "work_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "engine/core/retried.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "record.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kWorkPrefix = "gdtslam-fleet-";
constexpr const char* kWorkMark = "/.gdtslam-fleet";
constexpr const char* kMarkText = "gdtslam fleet made this folder and removes it again.\n";

// The mark goes last: whoever is killed meanwhile leaves a folder that a later one knows for one of these.
void remove_marked(const fs::path& folder) {
  std::error_code ignored;  // what cannot be removed is in nobody's way
  const fs::path mark = folder.string() + kWorkMark;
  std::vector<fs::path> rest;
  for (const fs::directory_entry& entry : list_folder(folder, ignored)) {
    if (entry.path() != mark) rest.push_back(entry.path());
  }
  for (const fs::path& path : rest) remove_tree(path, ignored);
  remove_tree(folder, ignored);
}

// A mark that can be locked has no owner any more. Where a file system knows no locks, none can be locked.
void remove_if_left(const fs::path& folder) {
  const std::string file = folder.string() + kWorkMark;
  const int mark = retried([&] { return ::open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW); });
  if (mark < 0) return;
  if (::flock(mark, LOCK_EX | LOCK_NB) == 0) remove_marked(folder);
  ::close(mark);
}

void remove_leftovers(const std::string& parent) {
  std::error_code failed;
  for (const fs::directory_entry& entry : list_folder(parent, failed)) {
    std::error_code ignored;
    const bool is_ours = entry.path().filename().string().starts_with(kWorkPrefix);
    if (is_ours && entry.is_directory(ignored) && !entry.is_symlink(ignored)) remove_if_left(entry.path());
  }
}

// The mark is locked before it has its name, so that nobody takes the folder for one that was left.
int locked_mark(const std::string& folder) {
  const std::string file = folder + kWorkMark;
  const std::string unnamed = file + ".new";
  const int mark = retried([&] { return ::open(unnamed.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600); });
  if (mark < 0) throw FileError(file, "cannot be created: " + errno_text(errno));
  (void)::flock(mark, LOCK_EX | LOCK_NB);
  std::string_view left = kMarkText;
  ssize_t count = 0;
  while (!left.empty() && (count = retried([&] { return ::write(mark, left.data(), left.size()); })) >= 0) {
    left.remove_prefix(static_cast<std::size_t>(count));
  }
  if (!left.empty() || std::rename(unnamed.c_str(), file.c_str()) != 0) {
    const int code = errno;
    ::close(mark);
    throw FileError(file, "cannot be written: " + errno_text(code));
  }
  return mark;
}

void copy_folder(const fs::path& from, const fs::path& to) {
  make_folder(to.string());
  std::error_code failed;
  for (const fs::directory_entry& entry : list_folder(from, failed)) {
    const fs::path name = entry.path().filename();
    if (entry.is_directory()) {
      copy_folder(entry.path(), to / name);
    } else {
      copy_file_atomically(entry.path().string(), (to / name).string());
    }
  }
  if (failed) throw FileError(from.string(), "cannot be listed: " + failed.message());
  sync_folder(to.string());
}

enum class Renamed { kDone, kIsThere, kOtherDisk };

Renamed rename_folder(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) == 0) return Renamed::kDone;
  if (errno == EEXIST || errno == ENOTEMPTY) return Renamed::kIsThere;
  if (errno == EXDEV) return Renamed::kOtherDisk;
  throw FileError(to, "cannot be written: " + errno_text(errno));
}

}  // namespace

WorkFolder::WorkFolder(const std::string& parent) {
  make_folder(parent);
  remove_leftovers(parent);
  std::string path = fmt::format("{}/{}{}-XXXXXX", parent, kWorkPrefix, ::getpid());
  if (::mkdtemp(path.data()) == nullptr) throw FileError(path, "cannot be created: " + errno_text(errno));
  try {
    mark_ = locked_mark(path);
  } catch (...) {
    std::error_code ignored;
    remove_tree(path, ignored);
    throw;
  }
  path_ = std::move(path);
}

WorkFolder::~WorkFolder() {
  remove_marked(path_);  // a later process removes the rest
  ::close(mark_);
}

std::string local_work_parent() {
  for (const char* name : {"SLURM_TMPDIR", "TMPDIR"}) {
    const char* const folder = std::getenv(name);
    if (folder != nullptr && *folder != '\0') return folder;
  }
  return "/tmp";
}

void move_into_atlas(const std::string& run_folder, const std::string& atlas, const std::string& run,
                     const std::string& staging) {
  const std::string to = atlas + "/" + run_path(run);
  const std::string parent = fs::path(to).parent_path().string();
  make_folder(parent);
  Renamed renamed = rename_folder(run_folder, to);
  if (renamed == Renamed::kOtherDisk) {
    const std::string copy = fmt::format("{}/{}-{}", staging, run, ::getpid());
    try {
      copy_folder(run_folder, copy);
    } catch (const fs::filesystem_error& error) {
      throw FileError(run_folder, "cannot be copied: " + error.code().message());
    }
    renamed = rename_folder(copy, to);
    std::error_code ignored;
    if (renamed == Renamed::kIsThere) remove_tree(copy, ignored);
  }
  if (renamed == Renamed::kOtherDisk) throw FileError(to, "cannot be written: " + errno_text(EXDEV));
  sync_folder(parent);
  sync_folder(atlas + "/runs");
}

}  // namespace gdtslam

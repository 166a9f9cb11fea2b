#include "work_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include "engine/core/files/folder_calls.hpp"
#include "engine/core/files/retried.hpp"
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

// The mark goes last, and only after all else: whoever is killed meanwhile, or cannot remove something, leaves a folder
// that a later one knows for one of these.
void remove_marked(const fs::path& folder) {
  std::error_code ignored;  // what cannot be removed is in nobody's way
  const fs::path mark = folder.string() + kWorkMark;
  if (remove_all_beside(mark, ignored) || remove_all_beside(mark, ignored)) remove_tree(folder, ignored);
}

// Whether mkdtemp made that name for one of these.
bool is_name_of_ours(std::string_view name) {
  constexpr std::size_t kDrawn = 6;
  if (!name.starts_with(kWorkPrefix)) return false;
  name.remove_prefix(kWorkPrefix.size());
  const std::size_t digits = name.find_first_not_of("0123456789");
  if (digits == 0 || digits == std::string_view::npos) return false;
  name.remove_prefix(digits);
  return name.size() == 1 + kDrawn && name.front() == '-' && name.find_first_of("-._", 1) == std::string_view::npos;
}

// A mark that can be locked has no owner any more. Where a file system knows no locks, none can be locked. Without a
// mark, one of these is left by a process that was killed before there was one, or after: it is empty.
void remove_if_left(const fs::path& folder) {
  const std::string file = folder.string() + kWorkMark;
  const int mark = retried([&] { return ::open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW); });
  if (mark < 0 && errno == ENOENT && is_name_of_ours(folder.filename().string())) ::rmdir(folder.c_str());
  if (mark < 0) return;
  if (retried([mark] { return ::flock(mark, LOCK_EX | LOCK_NB); }) == 0) remove_marked(folder);
  ::close(mark);
}

bool is_removed(int mark) {
  struct stat status {};
  return ::fstat(mark, &status) != 0 || status.st_nlink == 0;
}

// Nothing where another process has removed the folder, which it may take for one that was left until this holds the
// lock.
std::optional<int> locked_mark(const std::string& folder) {
  const std::string file = folder + kWorkMark;
  const int mark = retried([&] { return ::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600); });
  if (mark < 0 && (errno == ENOENT || errno == ESTALE)) return std::nullopt;
  if (mark < 0) throw FileError(file, "cannot be created: " + errno_text(errno));
  const bool is_locked = retried([mark] { return ::flock(mark, LOCK_EX | LOCK_NB); }) == 0;
  if ((!is_locked && errno == EWOULDBLOCK) || is_removed(mark)) {
    ::close(mark);
    return std::nullopt;
  }
  if (!write_whole(mark, kMarkText)) {
    const int code = errno;
    ::close(mark);
    throw FileError(file, "cannot be written: " + errno_text(code));
  }
  return mark;
}

void copy_folder(const fs::path& from, const fs::path& to) {
  make_folder(to.string());
  std::error_code failed;
  for (const fs::path& entry : list_folder(from, failed)) {
    const fs::path name = entry.filename();
    if (fs::is_directory(entry)) {
      copy_folder(entry, to / name);
    } else {
      copy_file_atomically(entry.string(), (to / name).string());
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

void remove_left_work(const std::string& parent) {
  std::error_code failed;
  for (const fs::path& entry : list_folder(parent, failed)) {
    std::error_code ignored;
    const bool is_ours = entry.filename().string().starts_with(kWorkPrefix);
    if (is_ours && fs::is_directory(fs::symlink_status(entry, ignored))) remove_if_left(entry);
  }
}

WorkFolder::WorkFolder(const std::string& parent) {
  make_folder(parent);
  remove_left_work(parent);
  constexpr int kTries = 100;
  for (int k = 0; k < kTries; ++k) {
    path_ = fmt::format("{}/{}{}-XXXXXX", parent, kWorkPrefix, ::getpid());
    if (::mkdtemp(path_.data()) == nullptr) throw FileError(path_, "cannot be created: " + errno_text(errno));
    try {
      if (const std::optional<int> mark = locked_mark(path_)) {
        mark_ = *mark;
        return;
      }
    } catch (...) {
      without_throwing([this] {
        std::error_code ignored;
        remove_tree(path_, ignored);
      });
      throw;
    }
  }
  throw FileError(path_, "cannot be created: other processes remove it each time");
}

WorkFolder::~WorkFolder() {
  without_throwing([this] { remove_marked(path_); });  // a later process removes the rest
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

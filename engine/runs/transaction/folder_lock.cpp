#include "folder_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "engine/core/files/retried.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

FolderLock::FolderLock(const std::filesystem::path& folder, Taken taken, const std::string& shown)
    : descriptor_(retried([&] { return ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); })) {
  const std::string name = shown.empty() ? folder.string() : shown;
  if (descriptor_ < 0) {
    if (errno == EACCES) return;  // a folder may allow writing but not reading
    throw FileError(name, "cannot be written to: " + errno_text(errno));
  }
  const int how = taken == Taken::kWait ? LOCK_EX : LOCK_EX | LOCK_NB;
  is_held_ = retried([&] { return ::flock(descriptor_, how); }) == 0;
  if (is_held_ || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw UsageError(
      fmt::format("another process is writing to '{}': wait until it has ended, or give another folder", name));
}

bool FolderLock::is_of(const std::filesystem::path& folder) const {
  struct stat held {};
  struct stat named {};
  if (descriptor_ < 0) return true;
  return ::fstat(descriptor_, &held) == 0 && ::lstat(folder.c_str(), &named) == 0 && held.st_dev == named.st_dev &&
         held.st_ino == named.st_ino;
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace gdtslam

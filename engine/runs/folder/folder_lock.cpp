#include "folder_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "engine/core/files/retried.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

FolderLock::FolderLock(const std::filesystem::path& folder, Taken taken)
    : descriptor_(retried([&] { return ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); })) {
  if (descriptor_ < 0) {
    if (errno == EACCES) return;  // a folder may allow writing but not reading
    throw FileError(folder.string(), "cannot be written to: " + errno_text(errno));
  }
  const int how = taken == Taken::kWait ? LOCK_EX : LOCK_EX | LOCK_NB;
  is_held_ = retried([&] { return ::flock(descriptor_, how); }) == 0;
  if (is_held_ || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw UsageError(fmt::format("another process is writing to '{}': wait until it has ended, or give another folder",
                               folder.string()));
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace gdtslam

#include "folder_transaction.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/core/files/retried.hpp"
#include "engine/io/atomic_file.hpp"
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

bool FolderLock::is_on(const std::filesystem::path& folder) const {
  struct stat held {};
  struct stat named {};
  if (descriptor_ < 0) return true;
  return ::fstat(descriptor_, &held) == 0 && ::lstat(folder.c_str(), &named) == 0 && held.st_dev == named.st_dev &&
         held.st_ino == named.st_ino;
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kStagingEnding = ".gdtslam-new";
constexpr mode_t kAllModes = 07777;

fs::path without_links(const std::string& path) {
  if (path.empty()) throw UsageError("--output: the folder of the results has no name");
  std::error_code failed;
  const fs::path named = fs::absolute(path, failed);
  const fs::path place = failed ? named : fs::weakly_canonical(named, failed);
  if (failed) throw FileError(path, "cannot be written to: " + failed.message());
  return place.has_filename() ? place : place.parent_path();  // a slash at the end does not matter
}

bool is_mount_point(const fs::path& folder) {
  struct statx found {};
  const bool is_known =
      ::statx(AT_FDCWD, folder.c_str(), 0, 0, &found) == 0 && (found.stx_attributes_mask & STATX_ATTR_MOUNT_ROOT) != 0;
  return is_known && (found.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
}

void require_exchangeable(const std::string& path, const fs::path& target) {
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(target, ignored);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw FileError(path, "cannot be written to: " + errno_text(ENOTDIR));
  }
  const auto refuse = [&path](const char* what) {
    throw UsageError(fmt::format("'{}' is {}, and the results replace the folder as a whole: name one in it, {}", path,
                                 what, (fs::path(path) / "run").string()));
  };
  if (is_mount_point(target)) refuse("a mount point");
  if (fs::equivalent(target, fs::current_path(ignored), ignored)) refuse("the working folder");
}

// A folder of this user, not a link to one.
bool is_own_folder(const fs::path& folder) {
  struct stat found {};
  return ::lstat(folder.c_str(), &found) == 0 && S_ISDIR(found.st_mode) && found.st_uid == ::geteuid();
}

}  // namespace

std::string staging_name(std::string_view name) { return fmt::format(".{}{}", name, kStagingEnding); }

FolderTransaction::FolderTransaction(const std::string& path, const BeforeRemoval& before_removal)
    : path_(path),
      target_(without_links(path)),
      staging_(target_.parent_path() / staging_name(target_.filename().string())) {
  require_exchangeable(path, target_);
  std::error_code failed;
  for (fs::path above = target_.parent_path(); !fs::exists(above, failed); above = above.parent_path()) {
    made_.push_back(above);
  }
  make_folder(target_.parent_path().string());
  lock_staging();
  const std::vector<fs::path> left = list_folder(staging_, failed);
  if (!left.empty() && before_removal) before_removal(staging_);
  for (const fs::path& file : left) {
    if (!failed) fs::remove_all(file, failed);
  }
  if (failed)
    throw FileError(path_, fmt::format("cannot be written to: '{}': {}", staging_.string(), failed.message()));
}

// Another process may exchange or remove the folder between opening and locking it. Then the name is that of another
// folder.
void FolderTransaction::lock_staging() {
  do {
    lock_.reset();
    const bool is_made = ::mkdir(staging_.c_str(), 0777) == 0 || errno == EEXIST;
    if (!is_made || !is_own_folder(staging_)) {
      throw FileError(path_, fmt::format("cannot be written to: '{}' cannot be made: {}", staging_.string(),
                                         is_made ? "something else has that name" : errno_text(errno)));
    }
    lock_.emplace(staging_, FolderLock::Taken::kRefuse, path_);
  } while (!lock_->is_on(staging_));
  struct stat old {};
  if (::stat(target_.c_str(), &old) == 0) ::chmod(staging_.c_str(), old.st_mode & kAllModes);
}

FolderTransaction::~FolderTransaction() {
  if (!lock_) return;
  without_throwing([this] {
    std::error_code ignored;
    fs::remove_all(staging_, ignored);
    for (const fs::path& above : made_) fs::remove(above, ignored);  // succeeds only if it is empty
  });
}

// On a file system without exchange, the name does not exist between two renamings.
void FolderTransaction::exchange() const {
  const bool has_old = lies_there(target_);
  if (has_old && ::renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0) return;
  const bool is_unknown = errno == EINVAL || errno == ENOSYS || errno == ENOTSUP;
  const fs::path aside = staging_.string() + "-old";
  std::error_code failed;
  if (has_old && !is_unknown) throw FileError(path_, "cannot be replaced: " + errno_text(errno));
  if (has_old) fs::rename(target_, aside, failed);
  if (!failed) fs::rename(staging_, target_, failed);
  std::error_code ignored;
  if (has_old) fs::rename(aside, failed ? target_ : staging_, ignored);
  if (failed) throw FileError(path_, "cannot be replaced: " + failed.message());
}

void FolderTransaction::commit() {
  sync_folder(staging_.string());
  std::optional<FolderLock> of_old;  // it has the name of the staging folder until it is removed
  if (lies_there(target_)) of_old.emplace(target_, FolderLock::Taken::kRefuse, path_);
  exchange();
  made_.clear();
  sync_folder(target_.parent_path().string());
  std::error_code ignored;  // without an old folder the name is free, and another writer may have taken it
  if (of_old && of_old->is_on(staging_)) fs::remove_all(staging_, ignored);
  lock_.reset();
}

}  // namespace gdtslam

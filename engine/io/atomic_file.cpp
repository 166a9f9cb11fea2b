#include "atomic_file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "byte_source.hpp"
#include "engine/core/ascii.hpp"
#include "engine/core/files/interruption.hpp"
#include "engine/core/files/retried.hpp"
#include "gdtslam/core/error.hpp"
#include "message_text.hpp"

namespace gdtslam {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 16;
constexpr mode_t kNewFileMode = 0666;  // the umask takes away what the user does not want
constexpr std::string_view kSuffix = ".tmp";

std::string folder_of(const std::string& file) {
  const std::string folder = fs::path(file).parent_path().string();
  return folder.empty() ? "." : folder;
}

std::string temporary_prefix(const std::string& file) { return "." + fs::path(file).filename().string() + "."; }

/// A writer holds a lock on its temporary file as long as it lives, so one that can be locked has no writer any more.
void remove_if_abandoned(const std::string& temporary) {
  const int descriptor = retried([&] { return ::open(temporary.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW); });
  if (descriptor < 0) {
    return;
  }
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
    ::unlink(temporary.c_str());
  }
  ::close(descriptor);
}

// "4711-0.tmp": a process and its file.
bool is_ending_of_temporary(std::string_view ending) {
  const std::size_t dash = ending.find('-');
  if (dash == std::string_view::npos || !ending.ends_with(kSuffix)) return false;
  const std::string_view serial = ending.substr(dash + 1);
  return is_digits(ending.substr(0, dash)) && is_digits(serial.substr(0, serial.size() - kSuffix.size()));
}

// A pipe waits for its reader, who may never come: a signal ends that.
int open_pipe_or_device(const std::string& path) {
  for (;;) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor >= 0 || errno != EINTR) return descriptor;
    if (is_asked_to_end()) throw Error(ExitCode::kInterrupted, "interrupted while '" + path + "' had no reader");
  }
}

void remove_abandoned(const std::string& target) {
  const std::string folder = folder_of(target);
  DIR* const listing = ::opendir(folder.c_str());
  if (listing == nullptr) {
    return;  // creating the file will say what is wrong with the folder
  }
  while (const dirent* entry = ::readdir(listing)) {
    const std::string_view name = static_cast<const char*>(entry->d_name);
    if (is_temporary_of(target, name)) {
      remove_if_abandoned(folder + "/" + std::string(name));
    }
  }
  ::closedir(listing);
}

}  // namespace

bool is_temporary_of(const std::string& file, std::string_view name) {
  const std::string prefix = temporary_prefix(file);
  return name.starts_with(prefix) && is_ending_of_temporary(name.substr(prefix.size()));
}

AtomicFile::AtomicFile(const std::string& path) : path_(path), target_(path) {
  buffer_.reserve(kBufferBytes);
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    throw FileError(path_, "cannot be written: it is a folder");
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    descriptor_ = open_pipe_or_device(path);
    if (descriptor_ < 0) {
      fail("cannot be written", errno);
    }
    return;
  }
  if (fs::is_symlink(fs::symlink_status(path, ignored))) {
    const fs::path resolved = fs::weakly_canonical(path, ignored);
    target_ = resolved.empty() ? path : resolved.string();
  }
  remove_abandoned(target_);
  open_temporary();
  struct stat old {};
  if (::stat(target_.c_str(), &old) == 0 && ::fchmod(descriptor_, old.st_mode & 07777U) != 0) {
    errno = 0;  // the file belongs to someone else: it gets the usual permissions of a new one
  }
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) {
    if (!temporary_.empty()) {
      ::unlink(temporary_.c_str());
    }
    ::close(descriptor_);
  }
}

bool AtomicFile::try_temporary(std::string name) {
  descriptor_ = retried([&] { return ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kNewFileMode); });
  if (descriptor_ < 0) {
    if (errno != EEXIST) {
      fail("cannot be created", errno);
    }
    return false;
  }
  // Someone who tidies up may have taken the lock between open and flock; then the file is theirs to remove.
  const bool is_locked = ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
  struct stat status {};
  if (is_locked && ::fstat(descriptor_, &status) == 0 && status.st_nlink > 0) {
    temporary_ = std::move(name);  // nothing that fails lies between the file and its owner
    return true;
  }
  ::close(descriptor_);
  descriptor_ = -1;
  return false;
}

void AtomicFile::open_temporary() {
  static std::atomic<unsigned> counter{0};
  constexpr int kAttempts = 100;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const unsigned serial = counter.fetch_add(1);
    if (try_temporary(
            fmt::format("{}/{}{}-{}{}", folder_of(target_), temporary_prefix(target_), ::getpid(), serial, kSuffix))) {
      return;
    }
  }
  throw FileError(path_, "cannot be created: too many temporary files of this name lie beside it; remove them");
}

void AtomicFile::fail(const char* what, int code) const {
  const std::string text = fmt::format("{}: {}", what, errno_text(code));
  if (code == EPIPE) throw NoReaderError(path_, text);
  throw FileError(path_, text);
}

void AtomicFile::write_through(const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t count = ::write(descriptor_, data, size);
    if (count < 0 && errno != EINTR) fail("cannot be written", errno);
    const std::size_t written = count < 0 ? 0 : static_cast<std::size_t>(count);
    // A pipe's reader may let it wait as well, which a signal cuts short.
    if (written < size && temporary_.empty() && is_asked_to_end())
      throw Error(ExitCode::kInterrupted, "interrupted while '" + path_ + "' was written");
    data += written;
    size -= written;
  }
}

const std::string& AtomicFile::written_path() const {
  if (temporary_.empty())
    throw FileError(path_, "is a pipe or a device, but a file is written out of order; give a file");
  return temporary_;
}

void AtomicFile::flush() {
  write_through(buffer_.data(), buffer_.size());
  buffer_.clear();
}

void AtomicFile::write(std::string_view text) {
  synced_ = false;
  if (buffer_.size() + text.size() > kBufferBytes) {
    flush();
  }
  if (text.size() > kBufferBytes) {
    write_through(text.data(), text.size());
  } else {
    buffer_.insert(buffer_.end(), text.begin(), text.end());
  }
}

void AtomicFile::write(std::span<const std::byte> data) {
  write(std::string_view(reinterpret_cast<const char*>(data.data()), data.size()));
}

void AtomicFile::rewrite_begin(std::string_view text) {
  flush();
  synced_ = false;
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = retried(
        [&] { return ::pwrite(descriptor_, text.data() + done, text.size() - done, static_cast<off_t>(done)); });
    if (count <= 0) fail("cannot be written twice, as its header must be", errno);
    done += static_cast<std::size_t>(count);
  }
}

void AtomicFile::sync() {
  flush();
  if (!temporary_.empty() && !synced_ && retried([&] { return ::fsync(descriptor_); }) != 0) {
    fail("cannot be written to the disk", errno);
  }
  synced_ = true;
}

void AtomicFile::take_name(bool keeps_old) {
  if (temporary_.empty()) return;
  struct stat old {};
  const bool is_folder = ::lstat(target_.c_str(), &old) == 0 && S_ISDIR(old.st_mode);
  if (keeps_old && !is_folder) {
    is_exchanged_ = ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0;
    was_absent_ = !is_exchanged_ && errno == ENOENT;
    const bool is_unknown = errno == EINVAL || errno == ENOSYS || errno == ENOTSUP;
    if (!is_exchanged_ && !was_absent_ && !is_unknown) fail("cannot take its name", errno);
  }
  if (!is_exchanged_ && ::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot take its name", errno);
  has_name_ = true;
}

void AtomicFile::give_back() {
  if (!has_name_) return;
  const std::string& from = is_exchanged_ ? temporary_ : target_;
  const std::string& to = is_exchanged_ ? target_ : temporary_;
  if ((is_exchanged_ || was_absent_) && ::rename(from.c_str(), to.c_str()) != 0) fail("cannot be put back", errno);
  if (!was_absent_) temporary_.clear();
  has_name_ = false;
}

void AtomicFile::finish() {
  const bool was_renamed = has_name_;
  if (is_exchanged_) ::unlink(temporary_.c_str());
  temporary_.clear();
  const int descriptor = std::exchange(descriptor_, -1);
  if (::close(descriptor) != 0 && errno != EINTR) {
    fail("cannot be closed", errno);
  }
  if (was_renamed) sync_folder(folder_of(target_));
}

void AtomicFile::commit() {
  sync();
  take_name(false);
  finish();
}

AtomicFile& AtomicFileSet::add(const std::string& path) {
  files_.push_back(std::make_unique<AtomicFile>(path));
  return *files_.back();
}

void AtomicFileSet::commit() {
  for (const auto& file : files_) {
    file->sync();
  }
  std::size_t named = 0;
  try {
    for (; named < files_.size(); ++named) files_[named]->take_name(true);
  } catch (...) {
    while (named > 0) files_[--named]->give_back();
    throw;
  }
  for (const auto& file : files_) file->finish();
  files_.clear();
}

void write_file_atomically(const std::string& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

void copy_file_atomically(const std::string& from, const std::string& to, const std::function<void()>& before_piece) {
  constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;
  const std::unique_ptr<ByteSource> source = open_file_source(from);
  AtomicFile copy(to);
  std::vector<char> piece(kPieceBytes);
  for (std::size_t count = 0; (count = source->read(piece)) > 0;) {
    if (before_piece) before_piece();
    copy.write(std::string_view(piece.data(), count));
  }
  std::error_code ignored;  // a file system may know no permissions
  fs::permissions(copy.written_path(), fs::status(from, ignored).permissions(), ignored);
  copy.commit();
}

void sync_folder(const std::string& path) {
  const int folder = retried([&] { return ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); });
  const bool is_synced =
      folder >= 0 && (retried([&] { return ::fsync(folder); }) == 0 || errno == EINVAL || errno == ENOTSUP);
  const int code = errno;
  if (folder >= 0) ::close(folder);
  if (is_synced || code == EACCES) return;  // a folder may allow writing but not reading; the files are on the disk
  throw FileError(path, "cannot be synced: " + errno_text(code));
}

void make_folder(const std::string& path) {
  std::error_code code;
  fs::create_directories(path, code);
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) {
    throw FileError(path, fmt::format("cannot be made a folder: {}",
                                      code ? errno_text(code.value()) : "something else has this name"));
  }
}

}  // namespace gdtslam

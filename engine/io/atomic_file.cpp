#include "atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "byte_source.hpp"
#include "engine/core/files/interruption.hpp"
#include "engine/core/files/retried.hpp"
#include "gdtslam/core/error.hpp"
#include "message_text.hpp"

namespace gdtslam {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 16;
constexpr mode_t kNewFileMode = 0666;  // the umask removes permissions

std::string parent_folder(const std::string& file) {
  const std::string folder = fs::path(file).parent_path().string();
  return folder.empty() ? "." : folder;
}

// Opening a pipe waits for a reader, which may never come; a signal ends the wait.
int open_pipe_or_device(const std::string& path) {
  for (;;) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor >= 0 || errno != EINTR) return descriptor;
    if (is_asked_to_end()) throw Error(ExitCode::kInterrupted, "interrupted while '" + path + "' had no reader");
  }
}

}  // namespace

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
  open_temporary();
  struct stat old {};
  if (::stat(target_.c_str(), &old) == 0 && ::fchmod(descriptor_, old.st_mode & 07777U) != 0) {
    errno = 0;  // another user's file gets the usual permissions of a new one
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

void AtomicFile::open_temporary() {
  static std::atomic<unsigned> counter{0};
  constexpr int kAttempts = 100;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::string name = fmt::format("{}/.{}.{}-{}.tmp", parent_folder(target_), fs::path(target_).filename().string(),
                                   ::getpid(), counter.fetch_add(1));
    descriptor_ = retried([&] { return ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kNewFileMode); });
    if (descriptor_ >= 0) {
      temporary_ = std::move(name);
      return;
    }
    if (errno != EEXIST) fail("cannot be created", errno);
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
    // A write to a pipe may also wait for its reader; a signal ends that wait.
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

void AtomicFile::take_name() {
  const bool is_renamed = !temporary_.empty();
  if (is_renamed && ::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot take its name", errno);
  temporary_.clear();
  const int descriptor = std::exchange(descriptor_, -1);
  if (::close(descriptor) != 0 && errno != EINTR) fail("cannot be closed", errno);
  if (is_renamed) sync_folder(parent_folder(target_));
}

void AtomicFile::commit() {
  sync();
  take_name();
}

AtomicFile& AtomicFileSet::add(const std::string& path) {
  files_.push_back(std::make_unique<AtomicFile>(path));
  return *files_.back();
}

void AtomicFileSet::commit() {
  for (const auto& file : files_) file->sync();
  for (const auto& file : files_) file->take_name();
  files_.clear();
}

void write_file_atomically(const std::string& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

void copy_file_atomically(const std::string& from, const std::string& to) {
  constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;
  const std::unique_ptr<ByteSource> source = open_file_source(from);
  AtomicFile copy(to);
  std::vector<char> piece(kPieceBytes);
  while (const std::size_t count = source->read(piece)) copy.write(std::string_view(piece.data(), count));
  std::error_code ignored;  // a file system may have no permissions
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

#include "byte_source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "engine/core/files/interruption.hpp"
#include "engine/io/decimal.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr int kSignalLook_ms = 200;  // a signal may come between the check of its flag and the wait

// True if a descriptor has bytes, its end or an error before the time is up. Else it has checked for a request to end.
bool has_something(int descriptor) {
  pollfd waited{.fd = descriptor, .events = POLLIN, .revents = 0};
  const int count = ::poll(&waited, 1, kSignalLook_ms);
  if (count > 0 || (count < 0 && errno != EINTR)) return true;
  AskedAfterSignals::ask();
  return false;
}

bool is_to_end() { return is_asked_to_end() || AskedAfterSignals::has_ended(); }

class FileSource final : public ByteSource {
 public:
  explicit FileSource(const std::string& path) : name_(path == "-" ? "standard input" : path) {
    descriptor_ = path == "-" ? STDIN_FILENO : open_to_read(path);
    if (descriptor_ < 0) {
      throw FileError(name_, fmt::format("cannot be opened: {}", errno_text(errno)));
    }
    struct stat status {};
    const bool known = ::fstat(descriptor_, &status) == 0;
    if (known && S_ISDIR(status.st_mode)) {
      close_file();
      throw FileError(name_, "is a folder; give a file");
    }
    is_file_ = known && S_ISREG(status.st_mode);
    if (is_file_) size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~FileSource() override { close_file(); }

  std::size_t read(std::span<char> target) override {
    ssize_t count = -1;
    for (;;) {
      if (!is_file_ && is_to_end()) return 0;
      if (!is_file_ && !has_something(descriptor_)) continue;
      count = ::read(descriptor_, target.data(), target.size());
      if (count >= 0 || errno != EINTR) break;
      AskedAfterSignals::ask();
    }
    if (count < 0) throw FileError(name_, fmt::format("cannot be read: {}", errno_text(errno)));
    position_ += static_cast<std::uint64_t>(count);
    return static_cast<std::size_t>(count);
  }
  [[nodiscard]] double progress() const override {
    return size_ == 0 ? -1.0 : std::min(1.0, static_cast<double>(position_) / static_cast<double>(size_));
  }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return position_; }

 private:
  void close_file() {
    if (descriptor_ > STDIN_FILENO) {
      ::close(descriptor_);
    }
    descriptor_ = -1;
  }

  std::string name_;
  int descriptor_ = -1;
  bool is_file_ = false;  // a plain file; else a pipe, a terminal or another device, which may wait
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
};

class MemorySource final : public ByteSource {
 public:
  explicit MemorySource(std::span<const std::byte> data) : data_(data) {}
  std::size_t read(std::span<char> target) override {
    const std::size_t count = std::min(target.size(), data_.size() - position_);
    if (count > 0) {
      std::memcpy(target.data(), data_.data() + position_, count);
    }
    position_ += count;
    return count;
  }
  [[nodiscard]] double progress() const override {
    return data_.empty() ? 1.0 : static_cast<double>(position_) / static_cast<double>(data_.size());
  }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return position_; }

 private:
  std::span<const std::byte> data_;
  std::size_t position_ = 0;
};

class HeadedSource final : public ByteSource {
 public:
  HeadedSource(std::string head, std::unique_ptr<ByteSource> rest) : head_(std::move(head)), rest_(std::move(rest)) {}
  std::size_t read(std::span<char> target) override {
    if (begin_ == head_.size()) return rest_->read(target);
    const std::size_t count = head_.copy(target.data(), target.size(), begin_);
    begin_ += count;
    return count;
  }
  [[nodiscard]] double progress() const override { return rest_->progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return rest_->bytes_from_file(); }
  [[nodiscard]] std::string defect() const override { return rest_->defect(); }

 private:
  std::string head_;
  std::size_t begin_ = 0;
  std::unique_ptr<ByteSource> rest_;
};

constexpr std::uint64_t kMostCounted = std::uint64_t{1} << 50U;

std::uint64_t free_kept_bytes() {
  constexpr std::int64_t kMostMib = std::int64_t{1} << 20U;
  const char* const text = std::getenv(kFreeKeptVariable);
  if (text == nullptr || *text == '\0') return kFreeKeptBytes;
  const char* const end = text + std::strlen(text);
  std::int64_t mib = 0;
  if (parse_int64(text, end, mib) != end || mib < 1 || mib > kMostMib) {
    throw ConfigError(
        fmt::format("{}: {} is no whole number of MiB from 1 to {}", kFreeKeptVariable, in_quotes(text), kMostMib));
  }
  return static_cast<std::uint64_t>(mib) << 20U;
}

Error no_writer(const std::string& path) {
  return {ExitCode::kInterrupted, "interrupted while '" + path + "' had no writer, or one that gave nothing"};
}

// Opening a pipe would wait for its writer, and a signal just before would not end that wait; so poll waits.
int open_pipe(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return descriptor;
  try {
    while (!has_something(descriptor)) {
      if (is_to_end()) throw no_writer(path);
    }
  } catch (...) {
    ::close(descriptor);
    throw;
  }
  ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
  return descriptor;
}

}  // namespace

// After a request to end, a pipe gives nothing, without a wait for its writer.
int open_to_read(const std::string& path) {
  std::error_code ignored;
  const bool is_pipe = std::filesystem::is_fifo(path, ignored);
  if (is_pipe && !AskedAfterSignals::has_ended()) return open_pipe(path);
  const char* const name = is_pipe ? "/dev/null" : path.c_str();
  for (;;) {
    const int descriptor = ::open(name, O_RDONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor >= 0 || errno != EINTR) return descriptor;
    AskedAfterSignals::ask();
    if (is_to_end()) throw no_writer(path);
  }
}

std::unique_ptr<ByteSource> open_file_source(const std::string& path) { return std::make_unique<FileSource>(path); }

std::unique_ptr<ByteSource> open_memory_source(std::span<const std::byte> data) {
  return std::make_unique<MemorySource>(data);
}

std::string read_head(ByteSource& source, std::size_t most) {
  std::string head(most, '\0');
  std::size_t size = 0;
  while (size < most) {
    const std::size_t count = source.read(std::span(head).subspan(size));
    if (count == 0) break;
    size += count;
  }
  head.resize(size);
  return head;
}

std::unique_ptr<ByteSource> with_head(std::string head, std::unique_ptr<ByteSource> rest) {
  return std::make_unique<HeadedSource>(std::move(head), std::move(rest));
}

std::string read_all(ByteSource& source, std::size_t limit, const std::string& name, const std::string& advice) {
  constexpr std::size_t kFirstPieceBytes = std::size_t{1} << 12U;
  constexpr std::size_t kPieceBytes = std::size_t{1} << 16U;
  std::string text;
  for (;;) {
    const std::size_t old_size = text.size();
    const std::size_t piece_bytes = std::clamp(old_size, kFirstPieceBytes, kPieceBytes);
    text.resize(old_size + piece_bytes);
    const std::size_t count = source.read({text.data() + old_size, piece_bytes});
    text.resize(old_size + count);
    if (text.size() > limit) {
      throw InputError({name, 0}, fmt::format("is longer than the {} bytes that are read{}", limit, advice));
    }
    check_kept_bytes(text.size(), source.bytes_from_file(), name);
    if (count == 0) {
      return text;
    }
  }
}

void check_kept_bytes(std::uint64_t kept, std::uint64_t from_disk, const std::string& name) {
  if (kept <= kKeptPerFileByte * std::min(from_disk, kMostCounted)) return;  // the variable is read only if needed
  const std::uint64_t free = free_kept_bytes();
  if (kept <= free || (kept - free) / kKeptPerFileByte <= from_disk) return;
  throw InputError({name, 0},
                   fmt::format("would take {} MiB unpacked, but has only {} KiB on the disk, as no measured data do; "
                               "if that is meant, store the file unpacked, or set {} to the MiB that it may take",
                               kept >> 20U, (from_disk >> 10U) + 1, kFreeKeptVariable));
}

void check_derived_bytes(std::uint64_t derived, std::uint64_t from_disk, const std::string& name,
                         std::string_view what) {
  const std::uint64_t for_size = kKeptPerFileByte * std::min(from_disk, kMostCounted);
  if (derived <= for_size) return;
  const std::uint64_t free = free_kept_bytes();
  if (derived - for_size <= kDerivedPerFree * free) return;
  const std::uint64_t wanted_mib = ((derived - for_size) / kDerivedPerFree >> 20U) + 1;
  throw InputError({name, 0}, fmt::format("{} would take {} MiB of memory, more than the {} MiB that a file of {} KiB "
                                          "may; if that is meant, set {}={}",
                                          what, derived >> 20U, (for_size + kDerivedPerFree * free) >> 20U,
                                          (from_disk >> 10U) + 1, kFreeKeptVariable, wanted_mib));
}

}  // namespace gdtslam

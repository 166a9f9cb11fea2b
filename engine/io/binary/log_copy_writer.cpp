#include "log_copy_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "engine/core/files/retried.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kFullFrameBytes = std::size_t{1} << 16U;
constexpr double kFullFrame_s = 5.0;  // of a live log no more is lost
constexpr std::chrono::seconds kSyncEvery{60};
constexpr int kFastLevel = -1;
constexpr mode_t kCopyMode = 0666;

}  // namespace

AppendedFile::AppendedFile(const std::string& path, std::uint64_t size) : path_(path) {
  descriptor_ = retried([&] { return ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, kCopyMode); });
  if (descriptor_ < 0) throw FileError(path_, "cannot be created: " + errno_text(errno));
  if (retried([&] { return ::ftruncate(descriptor_, static_cast<off_t>(size)); }) == 0) return;
  const int code = errno;
  ::close(descriptor_);
  throw FileError(path_, "cannot be written: " + errno_text(code));
}

AppendedFile::~AppendedFile() { ::close(descriptor_); }

void AppendedFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = retried([&] { return ::write(descriptor_, bytes.data(), bytes.size()); });
    if (count < 0) throw FileError(path_, "cannot be written: " + errno_text(errno));
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void AppendedFile::sync() {
  if (retried([this] { return ::fsync(descriptor_); }) == 0) return;
  throw FileError(path_, "cannot be written to the disk: " + errno_text(errno));
}

void sync_file(const std::string& path) {
  std::error_code failed;
  const std::uint64_t size = std::filesystem::file_size(path, failed);
  if (failed) throw FileError(path, "cannot be read: " + failed.message());
  AppendedFile(path, size).sync();
}

std::uint32_t log_copy_checksum(std::uint32_t records, std::string_view packed) {
  BytesOut count;
  const std::string head = count.whole(records).take();
  const uLong first = ::crc32(0, reinterpret_cast<const Bytef*>(head.data()), static_cast<uInt>(head.size()));
  return static_cast<std::uint32_t>(
      ::crc32(first, reinterpret_cast<const Bytef*>(packed.data()), static_cast<uInt>(packed.size())));
}

LogCopyWriter::LogCopyWriter() : context_(ZSTD_createCCtx()), synced_(Clock::now()) {
  if (!context_) throw Error(ExitCode::kFailed, "zstd cannot be started (out of memory)");
  BytesOut head;
  waiting_ = head.text(kLogCopyMagic).whole(kLogCopyVersion).take();
}

void LogCopyWriter::write_into(const std::string& path) {
  file_.emplace(path, 0);
  put(std::exchange(waiting_, {}));
}

void LogCopyWriter::go_on_with(const std::string& path, std::uint64_t whole_bytes) {
  file_.emplace(path, whole_bytes);
  if (whole_bytes == 0) put(waiting_);
  waiting_.clear();
}

void LogCopyWriter::put(const std::string& bytes) {
  if (!file_) {
    waiting_ += bytes;
    return;
  }
  file_->write(bytes);
  if (Clock::now() - synced_ < kSyncEvery) return;
  file_->sync();
  synced_ = Clock::now();
}

void LogCopyWriter::append_frame(const std::string& raw, std::uint32_t records) {
  packed_.resize(std::max(packed_.size(), ZSTD_compressBound(raw.size())));
  const std::size_t size =
      ZSTD_compressCCtx(context_.get(), packed_.data(), packed_.size(), raw.data(), raw.size(), kFastLevel);
  if (ZSTD_isError(size) != 0U) throw Error(ExitCode::kFailed, "zstd cannot pack a frame (out of memory)");
  const std::string_view packed = std::string_view(packed_).substr(0, size);
  BytesOut frame;
  frame.whole(static_cast<std::uint32_t>(size)).whole(records).whole(log_copy_checksum(records, packed)).text(packed);
  put(frame.bytes());
}

void LogCopyWriter::put_frame() {
  if (records_ == 0) return;
  append_frame(raw_.bytes(), std::exchange(records_, 0));
  raw_.clear();
  coder_.begin_frame();
  first_s_.reset();
}

// Frames are cut by what is in them, never by a clock: the same records are the same bytes.
void LogCopyWriter::add(const LogRecord& record) {
  const std::optional<double> stamp_s = stamp_of(record);
  if (stamp_s && !first_s_) first_s_ = stamp_s;
  coder_.append(raw_, record);
  ++records_;
  const bool is_long = stamp_s && !(std::fabs(*stamp_s - *first_s_) < kFullFrame_s);
  if (is_long || raw_.size() >= kFullFrameBytes) put_frame();
}

void LogCopyWriter::end(const LogCopyEnd& end) {
  put_frame();
  BytesOut raw;
  append_end(raw, end);
  append_frame(raw.bytes(), 0);
  if (file_) file_->sync();
  file_.reset();
}

}  // namespace gdtslam

#include "kept_stream.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <system_error>
#include <utility>
#include <variant>

#include "engine/core/files/retried.hpp"
#include "engine/core/signals_blocked.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/writers/log_writer.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostWaitingBytes = std::size_t{1} << 20U;
constexpr std::chrono::seconds kLongestWait{1};

}  // namespace

bool is_stream(const std::string& log) {
  std::error_code ignored;  // opening says what is wrong with a file that is not there
  const std::filesystem::file_status status = std::filesystem::status(log, ignored);
  return log == "-" || std::filesystem::is_other(status) || std::filesystem::is_fifo(status) ||
         std::filesystem::is_socket(status) || std::filesystem::is_character_file(status);
}

StreamFile::StreamFile(std::string file) : path_(std::move(file)), file_(path_, std::ios::binary) {
  if (!file_) throw FileError(path_, "cannot be created: " + errno_text(errno));
  const SignalsBlocked blocked;
  thread_ = std::thread([this] { work(); });
}

StreamFile::~StreamFile() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  over_.notify_one();
  thread_.join();
}

void StreamFile::add(const LogRecord& record) {
  std::string line = json_line(record);
  has_scan_ = has_scan_ || std::holds_alternative<ScanRecord>(record);
  const std::lock_guard lock(mutex_);
  lines_ += line;
  if (lines_.size() >= kMostWaitingBytes || !file_) write();
}

// The next add() or sync() reports what cannot be written.
void StreamFile::work() {
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, kLongestWait, [this] { return is_over_; })) {
    without_throwing([this] { write(); });
  }
}

void StreamFile::write() {
  if (!file_) throw FileError(path_, "cannot be written: " + errno_text(EIO));
  if (lines_.empty()) return;
  file_ << packed_chunk(lines_, ChunkPacking::kZstd) << std::flush;
  const int why = errno;
  if (!file_) throw FileError(path_, "cannot be written: " + errno_text(why));
  lines_.clear();
}

void StreamFile::sync() {
  const std::lock_guard lock(mutex_);
  write();
  const int descriptor = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  const bool is_synced = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int why = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!is_synced) throw FileError(path_, "cannot be written: " + errno_text(why));
}

std::optional<LogRecord> KeptStream::next() {
  std::optional<LogRecord> record = log_->next();
  if (record) file_->add(*record);
  return record;
}

}  // namespace gdtslam

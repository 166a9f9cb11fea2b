#include "kept_stream.hpp"

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <system_error>
#include <utility>

#include "engine/io/message_text.hpp"
#include "engine/io/writers/chunk_packer.hpp"
#include "engine/io/writers/table_log.hpp"
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

StreamFile::StreamFile(std::string file)
    : path_(std::move(file)), file_(path_, std::ios::binary), written_at_(std::chrono::steady_clock::now()) {
  if (!file_) throw FileError(path_, "cannot be created: " + errno_text(errno));
}

void StreamFile::add(const LogRecord& record) {
  lines_ += json_line(record);
  const bool is_due = std::chrono::steady_clock::now() - written_at_ >= kLongestWait;
  if (is_due || lines_.size() >= kMostWaitingBytes) flush();
}

void StreamFile::flush() {
  written_at_ = std::chrono::steady_clock::now();
  if (lines_.empty()) return;
  file_ << packed_chunk(std::exchange(lines_, {}), ChunkPacking::kZstd) << std::flush;
  if (!file_) throw FileError(path_, "cannot be written: " + errno_text(errno));
}

std::optional<LogRecord> KeptStream::next() {
  std::optional<LogRecord> record = log_->next();
  if (record) file_->add(*record);
  return record;
}

}  // namespace gdtslam

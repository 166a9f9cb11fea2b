// Writes the copy of a log (docs/formats.md, "Log copies") as the log is read: in frames that are readable each by
// itself, so that whatever moment the process is killed at, all whole frames before are there. The same records give
// the same bytes. One writer belongs to one thread.
#pragma once

#include <zstd.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "bytes.hpp"
#include "log_copy_records.hpp"

namespace gdtslam {

/// A file that grows at its end.
class AppendedFile {
 public:
  /// Made where it is not there; cut at `size`. Throws FileError, as all members do.
  AppendedFile(const std::string& path, std::uint64_t size);
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;
  ~AppendedFile();
  void write(std::string_view bytes);
  /// All to the disk.
  void sync();

 private:
  std::string path_;
  int descriptor_ = -1;
};

/// What others wrote of a file, to the disk. Throws FileError.
void sync_file(const std::string& path);

class LogCopyWriter {
 public:
  LogCopyWriter();
  /// What was written so far, and all that follows, goes into the file, a new one. Until then it is kept in memory.
  /// Throws FileError, as the other members do once there is a file.
  void write_into(const std::string& path);
  /// Goes on with a copy of which so many bytes are whole; the rest is cut off.
  void go_on_with(const std::string& path, std::uint64_t whole_bytes);
  void add(const LogRecord& record);
  /// All records so far into the file, the last of them in a frame that is not full.
  void flush() { put_frame(); }
  /// The last call: what is left, the end, and all to the disk.
  void end(const LogCopyEnd& end);

 private:
  struct FreeContext {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };
  using Clock = std::chrono::steady_clock;

  void put(const std::string& bytes);
  void put_frame();
  void append_frame(const std::string& raw, std::uint32_t records);

  std::unique_ptr<ZSTD_CCtx, FreeContext> context_;
  std::optional<AppendedFile> file_;
  std::string waiting_;  ///< for the file
  BytesOut raw_;         ///< of the frame in hand
  std::string packed_;   ///< of the last frame; its memory is used again
  RecordCoder coder_;
  std::uint32_t records_ = 0;  ///< in it
  std::optional<double> first_s_;
  Clock::time_point synced_;
};

/// Of a frame in the file: sizes, checksum of what follows.
struct LogCopyFrame {
  std::uint32_t packed_bytes = 0;
  std::uint32_t records = 0;  ///< 0: the end
  std::uint32_t checksum = 0;
};
inline constexpr std::string_view kLogCopyMagic = "gdtslam-log-copy";
inline constexpr std::uint32_t kLogCopyVersion = 1;
inline constexpr std::size_t kLogCopyHeadBytes = kLogCopyMagic.size() + sizeof(std::uint32_t);
inline constexpr std::size_t kLogCopyFrameBytes = 3 * sizeof(std::uint32_t);

/// CRC-32 of the packed bytes, going on from that of the number of records.
std::uint32_t log_copy_checksum(std::uint32_t records, std::string_view packed);

}  // namespace gdtslam

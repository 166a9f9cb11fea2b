// Writes the records of a log in one of the formats of docs/formats.md. Files appear whole or not at all: the caller
// commits the set of files once finish() has returned. Metres, radians, seconds; the same records give the same bytes
// on every host. Memory for a chunk (1 MiB) or a record. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/warning_counter.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

enum class LogFormat : std::uint8_t { kCarmen, kCsv, kJsonLines, kMcap };

/// How the chunks of MCAP files are packed.
enum class ChunkPacking : std::uint8_t { kNone, kLz4, kZstd };
/// The packing's name, "none", "lz4" or "zstd"; an MCAP file has an empty text for none.
std::string_view packing_name(ChunkPacking packing);
/// A whole chunk, packed; lz4 is a frame of independent blocks with a checksum. Throws Error if memory runs out.
std::string packed_chunk(const std::string& bytes, ChunkPacking packing);

class LogWriter {
 public:
  LogWriter() = default;
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;
  virtual ~LogWriter() = default;
  /// Returns true if the record is written; otherwise it is counted in left_out(). Throws FileError, as finish() does.
  virtual bool write(const LogRecord& record) = 0;
  /// Ends the files; the last call before they are committed.
  virtual void finish() = 0;
  /// Bytes so far, before gzip.
  [[nodiscard]] virtual std::uint64_t bytes() const = 0;
  /// Data that the format cannot carry, counted by kind.
  [[nodiscard]] const std::vector<LogReader::Warning>& left_out() const { return left_out_.list(); }

 protected:
  void leave_out(std::string_view kind, const std::string& first) { left_out_.add(kind, first); }

 private:
  WarningCounter left_out_;
};

/// The format by its name (`carmen`, `csv`, ...) if given, else by the ending of the file's name without .gz. Throws
/// UsageError that lists the formats.
LogFormat find_log_format(const std::string& path, const std::string& name);

/// The same by the ending alone; none for an unknown ending. Throws UsageError for the ending of a bag.
std::optional<LogFormat> log_format_by_ending(const std::string& path);

/// "carmen, csv, ...": for help and messages.
std::string log_format_names();

/// A record as a line of JSON, with the line end.
std::string json_line(const LogRecord& record);

/// Adds its files to `files`; "-" as the path is standard output. `packing` is for MCAP only, zstd if empty. Throws
/// UsageError for another format with a packing, FileError.
std::unique_ptr<LogWriter> make_log_writer(LogFormat format, const std::string& path,
                                           std::optional<ChunkPacking> packing, AtomicFileSet& files);

}  // namespace gdtslam

// One record of a log as bytes and back, bit for bit (docs/formats.md, "Log copies"). What scans have in common with
// the scan before is written only where it changes. Metres, radians, seconds. One coder belongs to one thread; linear
// in the beams.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// What the log's reader had to say, and whether it came to the log's end.
struct LogCopyEnd {
  bool is_whole = false;
  std::vector<LogReader::Warning> warnings;
};

/// One object writes the records of a frame, or reads them: each frame begins with a new one.
class RecordCoder {
 public:
  void append(BytesOut& out, const LogRecord& record);
  /// What is written next can be read without what was written before.
  void begin_frame() { laser_.reset(); }
  /// Throws InputError with the byte where something does not fit, or is a number that no reader gives.
  LogRecord record_from(BytesIn& in);

 private:
  /// What a laser has in common from scan to scan: bearings, limit, times of the beams, mount.
  using Laser = std::array<double, 8>;

  void append_scan(BytesOut& out, const ScanRecord& record);
  ScanRecord scan_from(BytesIn& in);

  std::optional<Laser> laser_;
  std::vector<char> room_;  ///< for ranges
};

void append_end(BytesOut& out, const LogCopyEnd& end);
/// Throws as record_from().
LogCopyEnd end_from(BytesIn& in);

/// The bytes of a record by itself, which are those of another one where the two are the same bit for bit.
std::string record_bytes(const LogRecord& record);

/// The stamp of a record that has one.
std::optional<double> stamp_of(const LogRecord& record);

}  // namespace gdtslam

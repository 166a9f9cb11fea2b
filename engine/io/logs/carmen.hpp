// Reader of CARMEN text logs (docs/formats.md gives every line kind, rule and limit): FLASER, ROBOTLASER1, ODOM, PARAM,
// and our own ENCODER and TILT. Metres, radians, seconds.
// Memory is bounded by the longest line allowed, whatever the log's length. One reader belongs to one thread.
//
// File order is kept. A range that is not a number or negative becomes +infinity, which no sensor limit passes.
// A malformed line throws InputError with file and line, or is counted with ReadOptions::lenient; a last line that was
// cut off is dropped and counted.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "engine/io/byte_source.hpp"
#include "engine/io/log_contents.hpp"
#include "engine/io/scan_sequence.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// A log out of a source that was unpacked already. Throws InputError when it is empty or not text.
std::unique_ptr<DescribedLog> open_carmen(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                          const ReadOptions& options);

/// The content of one line.
struct CarmenLine {
  std::optional<LogRecord> record;  ///< empty for comments, blank lines and message kinds that are not read
  std::string_view skipped_kind;    ///< kind of a message that is not read
  RangeRepairs repairs;
  int pose_decimals = 0;  ///< most digits behind the point of the poses of a scan, from which its mount was computed
  bool is_whole = true;   ///< the fields after the ones we use are there, so nothing we use was cut off
};

/// One line to one record, without state between lines. Throws MalformedLine (field_cursor.hpp).
CarmenLine parse_carmen_line(std::string_view text, const ReadOptions& options);

/// Bearings of a scan of which only the number of beams is known.
struct BearingRule {
  double first_rad = 0.0;
  double step_rad = 0.0;
};

/// SICK scanners by their number of beams, right to left: 101, 201 and 401 beams span 100 degrees; otherwise 180
/// degrees, the last beam at +90 degrees for odd numbers and one step before it for even ones. One beam points ahead.
BearingRule bearing_rule(std::size_t beams);

}  // namespace gdtslam

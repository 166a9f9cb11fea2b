// Reader of CARMEN text logs (docs/formats.md gives every line kind, rule and limit): FLASER, ROBOTLASER1, ODOM, PARAM,
// and our own ENCODER and TILT. Metres, radians, seconds.
// Memory is bounded by the longest line allowed. One reader belongs to one thread.
//
// File order is kept. A range that is not a number or negative becomes +infinity, which no sensor limit passes.
// A malformed line throws InputError with file and line, or is counted with ReadOptions::lenient; a cut last line is
// dropped and counted.
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

/// A log from an unpacked source. Throws InputError if it is empty or not text.
std::unique_ptr<DescribedLog> open_carmen(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                          const ReadOptions& options);

/// The content of one line.
struct CarmenLine {
  std::optional<LogRecord> record;  ///< empty for comments, blank lines and unused kinds of messages
  std::string_view skipped_kind;    ///< kind of an unused message
  RangeRepairs repairs;
  int pose_decimals = 0;  ///< most digits after the point in the two poses of a scan that give its mount
  bool is_whole = true;   ///< later, unused fields are there, so no used field was cut
};

/// One line to one record, without state between lines. Throws MalformedLine (field_cursor.hpp).
CarmenLine parse_carmen_line(std::string_view text, const ReadOptions& options);

/// Bearings of a scan by its number of beams.
struct BearingRule {
  double first_rad = 0.0;
  double step_rad = 0.0;
};

/// SICK scanners by their number of beams, right to left: 101, 201 and 401 beams span 100 degrees; otherwise 180
/// degrees, the last beam at +90 degrees for odd numbers and one step before it for even ones. One beam points ahead.
BearingRule bearing_rule(std::size_t beams);

}  // namespace gdtslam

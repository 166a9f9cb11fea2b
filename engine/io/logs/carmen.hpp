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
#include <string>

#include "engine/io/byte_source.hpp"
#include "engine/io/log_contents.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// A log out of a source that was unpacked already. Throws InputError when it is empty or not text.
std::unique_ptr<DescribedLog> open_carmen(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                          const ReadOptions& options);

/// Bearings of a scan of which only the number of beams is known.
struct BearingRule {
  double first_rad = 0.0;
  double step_rad = 0.0;
};

/// SICK scanners by their number of beams, right to left: 101, 201 and 401 beams span 100 degrees; otherwise 180
/// degrees, the last beam at +90 degrees for odd numbers and one step before it for even ones. One beam points ahead.
BearingRule bearing_rule(std::size_t beams);

}  // namespace gdtslam

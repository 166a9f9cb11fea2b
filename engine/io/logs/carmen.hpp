// Reader of CARMEN text logs (docs/formats.md gives every line kind, rule and limit): FLASER, ROBOTLASER1, ODOM, PARAM,
// and our own ENCODER and TILT. Plain or gzip, told apart by their first bytes. Metres, radians, seconds.
// Memory is bounded by the longest line allowed, whatever the log's length. One reader belongs to one thread.
//
// File order is kept. A range that is not a number or negative becomes +infinity, which no sensor limit passes.
// A malformed line throws InputError with file and line, or is counted with ReadOptions::lenient; a last line that was
// cut off is dropped and counted.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "engine/io/byte_source.hpp"
#include "engine/io/log_contents.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// The longest line that is read; a longer one is malformed.
inline constexpr std::size_t kMaxLogLineBytes = std::size_t{4} << 20;

/// A log in a file; "-" is standard input. Throws FileError, or InputError when it is empty or not text.
std::unique_ptr<DescribedLog> open_carmen(const std::string& path, const ReadOptions& options);

/// A log out of a source that was unpacked already.
std::unique_ptr<DescribedLog> open_carmen(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                          const ReadOptions& options);

/// A log in memory, which must outlive the reader; `name` stands in messages.
std::unique_ptr<DescribedLog> open_carmen(std::span<const std::byte> data, const std::string& name,
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

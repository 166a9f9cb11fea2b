// One line of a CARMEN log to one record. No state between lines. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "engine/io/scan_sequence.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {

/// A line that breaks its format; what() says how.
class MalformedLine : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a line holds.
struct CarmenLine {
  std::optional<LogRecord> record;  ///< empty for comments, blank lines and message kinds that are not read
  std::string_view skipped_kind;    ///< of a message that is not read
  RangeRepairs repairs;
  int pose_decimals = 0;  ///< most digits behind the point of the poses of a scan, from which its mount was computed
  bool is_whole = true;   ///< the fields after the ones we use are there, so nothing we use was cut off
};

/// Throws MalformedLine.
CarmenLine parse_carmen_line(std::string_view text, const ReadOptions& options);

}  // namespace gdtslam

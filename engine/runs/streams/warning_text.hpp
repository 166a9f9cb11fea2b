// What was skipped or mended in a log, as users read it: the command prints this line, and the C interface tells it.
#pragma once

#include <fmt/format.h>

#include <string>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

inline std::string warning_text(const LogReader::Warning& warning) {
  return fmt::format("warning: {} ({} times; first: {})", warning.kind, warning.count, warning.first);
}

}  // namespace gdtslam

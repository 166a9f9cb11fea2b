// Warnings about skipped or corrected parts of a log, and faults with known causes, as single lines for the command and
// the C interface.
#pragma once

#include <fmt/format.h>

#include <string>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

inline std::string warning_text(const LogReader::Warning& warning) {
  return fmt::format("warning: {} ({} times; first: {})", warning.kind, warning.count, warning.first);
}

inline std::string finding_text(const LogFinding& finding) {
  if (finding.options.empty()) return fmt::format("{} ({})", finding.what, finding.evidence);
  return fmt::format("{} ({}); {} {}", finding.what, finding.evidence,
                     finding.is_mended ? "map mends it, as with" : "to mend it:", finding.options);
}

}  // namespace gdtslam

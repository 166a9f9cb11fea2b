// Warnings about skipped or mended parts of a log, and faults whose causes are known, one line each, which the
// command prints and the C interface gives out.
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

// What there is to say about a mapped log, on standard error.
#pragma once

#include <vector>

#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// Each kind on a line of its own.
void print_warnings(const std::vector<LogReader::Warning>& warnings);

/// The warnings, and the first scans in doubt.
void print_remarks(const MapOutcome& outcome);

}  // namespace gdtslam

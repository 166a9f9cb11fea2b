// Found poses as a table for `gdtslam evaluate` and other programs: the names of the columns, then one line a scan
// (docs/formats.md). Thread-safe; O(scans).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "drive.hpp"
#include "run.hpp"

namespace gdtslam {

/// For programs: "poor-fit".
std::string json_name(Verdict verdict);

std::string table_text(const std::vector<LocalizedScan>& scans);
std::string table_text(const TrackedDrive& drive);

/// Scans by verdict, in the order of kVerdicts; by whereabouts, in the order of kWhereabouts.
std::array<std::uint64_t, kVerdicts.size()> count_verdicts(const std::vector<LocalizedScan>& scans);
std::array<std::uint64_t, kWhereabouts.size()> count_whereabouts(const TrackedDrive& drive);

}  // namespace gdtslam

// What the report of a run says against its map: scans that were not matched, loops that are not believed, wheels that
// are off, stretches that are not to be trusted. Thread-safe; linear in the report.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/runs/folder/report_reader.hpp"
#include "engine/runs/loops/loops_report.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// What closing the loops came to, as the report has it.
struct LoopFindings {
  std::uint64_t searches = 0;
  /// Of the points of keyframes from the lines of others; nothing where none were laid on each other.
  std::optional<double> rms_m;
  /// Without what was measured, T_from_to and information, which the report does not have; angles in radians.
  std::vector<ClosedLoop> loops;
  WheelReport wheels;
  double above_m = 0.0;  ///< from here on a standard deviation is too large
  double sigma_median_m = 0.0;
  double sigma_max_m = 0.0;
  std::vector<UncertainStretch> uncertain;
};

/// A report's doubts.
struct RunDoubts {
  bool was_interrupted = false;
  std::uint64_t scans = 0;
  std::uint64_t accepted = 0;          ///< of the scans without doubt,
  std::uint64_t weak = 0;              ///< with weak evidence,
  std::uint64_t refused = 0;           ///< not at all
  std::uint64_t restarts = 0;          ///< keyframes where odometry says, after a long stretch without a match
  std::vector<LogFinding> findings{};  ///< faults of the logs whose causes are known
  std::optional<LoopFindings> loops;   ///< nothing where the run closed none
};

/// Faults of logs as reports and continue.json have them.
nlohmann::ordered_json findings_json(const std::vector<LogFinding>& findings);
/// The list `findings` of an object; empty in files of versions that had none. Throws InputError.
std::vector<LogFinding> findings_from(const ReportReader& object);

/// Throws InputError where a key is missing or of another type, or names a scan beyond `scans`.
RunDoubts doubts_of(const ReportReader& report, std::uint64_t scans);

}  // namespace gdtslam

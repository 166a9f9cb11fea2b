// Doubts of a run's report about its map: scans that were not matched, rejected loops, wrong wheels, unreliable
// stretches. Thread-safe; linear in the report.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/folder/loop_files.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// Result of closing the loops, from the report.
struct LoopFindings {
  std::uint64_t searches = 0;
  /// Distance of the points of keyframes from the lines of others; none if no keyframe was matched with another.
  std::optional<double> rms_m;
  /// Without T_from_to and information, which the report does not have; angles in radians.
  std::vector<ClosedLoop> loops;
  WheelReport wheels;
  double above_m = 0.0;  ///< from this value on, a standard deviation is too large
  double sigma_median_m = 0.0;
  double sigma_max_m = 0.0;
  std::vector<UncertainStretch> uncertain;
};

/// A report's doubts.
struct RunDoubts {
  bool was_interrupted = false;
  std::uint64_t scans = 0;
  std::uint64_t accepted = 0;          ///< scans matched without doubt
  std::uint64_t weak = 0;              ///< scans matched with weak evidence
  std::uint64_t refused = 0;           ///< scans without a match
  std::uint64_t restarts = 0;          ///< keyframes placed by odometry after a long stretch without a match
  std::vector<LogFinding> findings{};  ///< faults of the logs whose causes are known
  std::optional<LoopFindings> loops;   ///< none if the run closed no loops
};

/// Faults of logs, for reports and continue.json.
nlohmann::ordered_json findings_json(const std::vector<LogFinding>& findings);
/// The list `findings` of an object; empty in files of older versions. Throws InputError.
std::vector<LogFinding> findings_from(const ReportReader& object);

/// Throws InputError if a key is missing or has another type, or names a scan beyond `scans`.
RunDoubts read_doubts(const ReportReader& report, std::uint64_t scans);

// Doubts about the map of a run, their places, and advice: `gdtslam doctor --after`. Frame: map. Thread-safe; linear in
// poses and loops.

/// One doubt.
struct ReviewNote {
  std::string_view about;  ///< log, run, loops, stretch, loop, scans or wheels; of static storage
  std::string finding;
  std::string advice;
  std::optional<Point2> at_m{};  ///< the place, if there is one
};

/// A share of scans: "5.4 %", "0.04 %".
std::string percent_text(std::uint64_t part, std::uint64_t whole);

/// Notes on a run, first those on the whole map; empty if there is no doubt. `covariances` has one for each pose, or
/// none if the run has no covariance.csv; the place of a stretch is then its middle.
std::vector<ReviewNote> review_notes(const RunDoubts& doubts, const Trajectory& trajectory,
                                     std::span<const PoseCovariance> covariances);

}  // namespace gdtslam

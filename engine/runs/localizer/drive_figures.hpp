// What a followed drive adds up to: how much of it is known, when the robot was found, the share that is right by the
// reference, and a table of all scans. Thread-safe; O(n log n).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "drive.hpp"
#include "engine/runs/evaluation/errors.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {

/// A stretch of the drive of which no pose is known, at its start or after the robot was lost; a search ends it, or the
/// log does.
struct UnknownStretch {
  std::uint64_t first = 0;  ///< index of a scan
  std::uint64_t scans = 0;
  double lasted_s = 0.0;  ///< by the log's clock, up to the scan that was found, else to the last one
  bool is_found = false;
};

struct DriveFigures {
  std::array<std::uint64_t, kWhereabouts.size()> whereabouts{};  ///< in the order of kWhereabouts
  std::uint64_t ambiguous = 0;
  std::uint64_t searches = 0;
  std::vector<UnknownStretch> stretches;
  Share within;                ///< of the scans with a reference in a place that the map has
  std::uint64_t unmapped = 0;  ///< scans with a reference in another place
  std::uint64_t without = 0;   ///< scans in mapped places of which no pose is known
  std::uint64_t off = 0;       ///< scans in mapped places whose pose is not within the limits
  ErrorSummary distance_m;     ///< of those within
  ErrorSummary angle_deg;
  /// Squared errors in standard deviations of the covariance, of the matched poses in mapped places that are right: 3
  /// by the mean, 2.37 by the median, if the covariances are.
  ErrorSummary squared_sigmas;
};
DriveFigures figures_of(const TrackedDrive& drive);

/// What scans took, seconds of wall time; 0 where there is none.
struct StepTimes {
  std::uint64_t count = 0;
  double median_s = 0.0;
  double p99_s = 0.0;
  double max_s = 0.0;
};
/// Of scans for which the whole map was searched, or of all others.
StepTimes times_of(const TrackedDrive& drive, bool are_searched);

/// The table of --table: column names, then one line a scan, docs/formats.md.
std::string table_text(const TrackedDrive& drive);

}  // namespace gdtslam

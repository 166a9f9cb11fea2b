// Faults of logs that a run finds: for files before the first scan, by reading them an extra time, and for streams at
// the end. Each look belongs to one thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

/// Facts about the first log, found before the first scan.
struct RunPreparation {
  std::optional<OdometryDelay> delay{};
  std::vector<LogFinding> findings{};
};

/// Sets log.max_range of the request to a constant that stands for "nothing seen", so that every later reading of the
/// logs treats it as no return. Does nothing for a live log. Cost: the logs are read until the laser has moved between
/// 1,000 scans.
std::vector<LogFinding> look_at_ranges(MapRequest& request);

/// Finds faults that the motion shows, and the delay of odometry, which it warns about. Corrects wrong times of beams
/// in log.beam_times of the request. Cost: up to 3,000 scans are matched, twice if times are wrong.
RunPreparation look_at_motion(MapRequest& request, const std::string& log);

/// Adds faults of a log that could not be checked before mapping. `log` is the log, or the file with its stream. Its
/// motion is checked only if many scans are doubtful.
void look_afterwards(const MapRequest& request, const std::string& log, MapOutcome& outcome);

}  // namespace gdtslam

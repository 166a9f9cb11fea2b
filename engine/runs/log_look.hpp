// Faults of logs that a run finds besides the map: before the first scan by a second reading of files, and at the
// end for what could be read only once. Each look belongs to one thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

/// Facts about the first log that a run learns before its first scan.
struct RunPreparation {
  std::optional<OdometryDelay> delay{};
  std::vector<LogFinding> findings{};
};

/// A constant that stands for "nothing seen" becomes log.max_range of the request, so that all that reads its logs
/// again takes it for no return. Nothing for a log that is mapped live. Cost: the logs are read until the laser has
/// moved between 1,000 scans.
std::vector<LogFinding> look_at_ranges(MapRequest& request);

/// Faults that the motion shows, and the odometry's delay; warns of a delay. Wrong times of beams are put right in
/// log.beam_times of the request. Cost: up to 3,000 scans are matched, twice if times are wrong.
RunPreparation look_at_motion(MapRequest& request, const std::string& log);

/// Adds faults of a log that could not be looked at before. `log` is the log, or the file in which its stream is kept.
/// Its motion counts if many of its scans are in doubt.
void look_afterwards(const MapRequest& request, const std::string& log, MapOutcome& outcome);

}  // namespace gdtslam

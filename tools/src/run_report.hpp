// report.json: what a run did, for programs (docs/formats.md gives every key). Thread-safe.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "map_run.hpp"
#include "nodding_run.hpp"

namespace gdtslam {

/// The version of the format.
inline constexpr int kReportVersion = 1;

/// The part of a nodding laser.
struct NoddingReport {
  const NoddingJob& job;
  const NoddingOutcome& outcome;
};

/// The report of a run; `nodding` may be null. `written_s` is the time that the other files took.
nlohmann::ordered_json report_of(const MapJob& job, const MapOutcome& outcome, const NoddingReport* nodding,
                                 const Mapper& mapper, const DeviceInfo& device, double written_s);

}  // namespace gdtslam

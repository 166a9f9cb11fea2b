// report.json: what a run did, for programs (docs/formats.md gives every key). Thread-safe.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/runs/mapping/map_run.hpp"
#include "engine/runs/mapping/nodding_run.hpp"
#include "gdtslam/compute/backend.hpp"

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

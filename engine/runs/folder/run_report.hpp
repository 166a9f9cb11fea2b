// report.json: what a run did, for programs (docs/formats.md gives every key). Thread-safe.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/runs/mapping/map_run.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

/// The version of the format.
inline constexpr int kReportVersion = 1;

/// The report of a run; `nodding` is null where the laser does not nod. `written_s` is the time that the other files
/// took.
nlohmann::ordered_json run_report(const MapJob& job, const NoddingJob* nodding, const MapOutcome& outcome,
                                  const Mapper& mapper, const DeviceInfo& device, double written_s);

}  // namespace gdtslam

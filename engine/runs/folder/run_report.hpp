// What a run leaves in its folder, and report.json: what it did, for programs (docs/formats.md gives every key).
// Thread-safe.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "engine/runs/mapping/map_run.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/runs/settings.hpp"
#include "run_folder.hpp"

namespace gdtslam {

/// The version of the format.
inline constexpr int kReportVersion = 1;

/// The report of a run; `nodding` is null where the laser does not nod. `written_s` is the time that the other files
/// took.
nlohmann::ordered_json run_report(const MapJob& job, const NoddingJob* nodding, const MapOutcome& outcome,
                                  const GlobalField& field, const DeviceInfo& device, double written_s);

/// Writes what a run made into its folder: map, distance field, trajectory, graph, pictures, configuration and report,
/// all or nothing; returns the text of report.json. Throws FileError. A picture that fails is added to the outcome's
/// warnings. `nodding` is null for a laser that does not nod; its cloud has been written by now.
std::string write_run(RunFolder& folder, const MapJob& job, const NoddingJob* nodding, MapOutcome& outcome,
                      const GlobalField& field, const DeviceInfo& device, Settings settings);

/// What a report says of the device that did the work.
inline nlohmann::ordered_json device_json(const DeviceInfo& device) {
  return {{"name", device.name}, {"kind", device.kind}, {"driver", device.driver}, {"threads", device.threads}};
}

}  // namespace gdtslam

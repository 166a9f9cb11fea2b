// Files of a run folder, and report.json, the record of the run for programs (docs/formats.md gives every key).
// Thread-safe.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "engine/runs/drive/map_run.hpp"
#include "engine/runs/drive/stopwatch.hpp"
#include "engine/runs/folder/loop_files.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/runs/settings.hpp"
#include "run_folder.hpp"

namespace gdtslam {

/// The version of the format.
inline constexpr int kReportVersion = 1;

/// Description of a distance field in the report; the field itself may be gone by then.
struct WrittenField {
  GridGeometry geometry;
  std::string sha256;
  std::size_t tiles = 0;  ///< number of tiles; 0: in one piece
};
/// Writes gdt.png and gdt.yaml. Throws FileError.
WrittenField write_run_field(RunFolder& folder, const MapRequest& request, const GlobalField& field, RunTimes& times);

/// Writes a map in tiles to the run's folder `tiles`, and sets the outcome's small map. Throws like write_tiles().
WrittenField write_run_tiles(RunFolder& folder, const MapRequest& request, RunTimes& times, MapOutcome& outcome);

/// Request and products of a run, besides its outcome.
struct RunFacts {
  const MapRequest& request;
  const NoddingJob* nodding = nullptr;  ///< null if the laser does not nod; its cloud is already written
  const WrittenField& field;
  const DeviceInfo& device;
};

/// Hashes of written files.
struct WrittenHashes {
  std::string trajectory;
  std::string keyframes;  ///< empty if there is no such file
};
/// Stages map, trajectory, graph, pictures, configuration and keyframes of a run; the caller adds the report and
/// commits. `graph` replaces the outcome's graph; null: the outcome's. Throws FileError. A failed picture is added to
/// the outcome's warnings.
WrittenHashes write_run_files(RunFolder& folder, const MapRequest& request, RunTimes& times, MapOutcome& outcome,
                              const GraphLines* graph = nullptr);

/// Writes map, trajectory, graph, pictures, configuration and report to the run's folder, all or nothing; returns the
/// text of report.json. Sets the outcome's times from `times`, writing included. A failed picture is added to the
/// outcome's warnings. Throws FileError.
std::string write_run(RunFolder& folder, RunFacts facts, RunTimes& times, MapOutcome& outcome);

/// The report's description of a grid.
nlohmann::ordered_json geometry_json(const GridGeometry& geometry);

/// The report's description of the device that did the work.
inline nlohmann::ordered_json device_json(const DeviceInfo& device) {
  return {{"name", device.name}, {"kind", device.kind}, {"driver", device.driver}, {"threads", device.threads}};
}

}  // namespace gdtslam

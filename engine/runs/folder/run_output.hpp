// Writes what a run made into its folder: map, distance field, trajectory, picture, configuration and report.
#pragma once

#include <string>

#include "engine/runs/mapping/map_run.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/runs/settings.hpp"
#include "run_folder.hpp"
#include "run_report.hpp"

namespace gdtslam {

/// All files of the run, all or nothing; returns the text of report.json. Throws FileError.
/// `nodding` is null for a laser that does not nod; its cloud has been written by now.
std::string write_run(RunFolder& folder, const MapJob& job, const NoddingJob* nodding, const MapOutcome& outcome,
                      const Mapper& mapper, const DeviceInfo& device, Settings settings);

}  // namespace gdtslam

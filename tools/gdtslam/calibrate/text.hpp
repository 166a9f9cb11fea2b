// A calibration as a table to read and as JSON. Thread-safe.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "engine/runs/linkage/linkage_file.hpp"
#include "tools/gdtslam/calibrations/run.hpp"

namespace gdtslam {

std::string as_text(const CalibrateOutcome& outcome);
nlohmann::ordered_json as_json(const CalibrateOutcome& outcome);
/// What the linkage file states of the parameters: those that something holds.
std::vector<ParameterSigma> uncertainty_of(const calib::CalibrationResult& result);

}  // namespace gdtslam

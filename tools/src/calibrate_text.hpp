// A calibration as a table to read and as JSON. Thread-safe.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "calibrate_run.hpp"
#include "linkage_file.hpp"

namespace gdtslam {

std::string text_of(const CalibrateOutcome& outcome);
nlohmann::ordered_json json_of(const CalibrateOutcome& outcome);
/// What the linkage file states of the parameters: those that something holds.
std::vector<ParameterSigma> uncertainty_of(const calib::CalibrationResult& result);

}  // namespace gdtslam

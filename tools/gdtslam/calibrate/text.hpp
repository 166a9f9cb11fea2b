// A calibration as a table to read and as JSON. Thread-safe.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "run.hpp"
#include "self_run.hpp"

namespace gdtslam {

std::string as_text(const CalibrateOutcome& outcome);
std::string as_text(const SelfCalibrateOutcome& outcome);
nlohmann::ordered_json as_json(const CalibrateOutcome& outcome);
nlohmann::ordered_json as_json(const SelfCalibrateOutcome& outcome);

}  // namespace gdtslam

// Output of a comparison: text in the units of the paper's tables (cm, degrees), JSON and CSV in metres and degrees,
// and a picture. Times are kept apart from the reproducible values: in JSON under "times", in CSV in the last column.
// Thread-safe.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "gdtslam/drawing/canvas.hpp"
#include "run.hpp"

namespace gdtslam {

std::string as_text(const CompareJob& job, const CompareOutcome& outcome);
nlohmann::ordered_json as_json(const CompareJob& job, const CompareOutcome& outcome);
/// One row for each trial.
std::string as_csv(const CompareJob& job, const CompareOutcome& outcome);
/// "20 cm, 5°"; "prediction" for level 0.
std::string level_text(const CompareJob& job, std::uint32_t level);

/// Success rate over the start's distance from the solution, with 95 % intervals, and the errors of starts at the
/// odometry's prediction as boxes and as distribution. Pixels.
Canvas compare_picture(const CompareJob& job, const CompareOutcome& outcome, const std::string& log);

}  // namespace gdtslam

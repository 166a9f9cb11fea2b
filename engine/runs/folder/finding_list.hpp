// Faults of logs whose causes are known, as JSON: in report.json, in continue.json and of `gdtslam doctor --json`.
// Thread-safe.
#pragma once

#include <nlohmann/json.hpp>

#include <vector>

#include "gdtslam/runs/outcome.hpp"
#include "report_reader.hpp"

namespace gdtslam {

nlohmann::ordered_json findings_json(const std::vector<LogFinding>& findings);

/// The list `findings` of an object; empty in files of versions that had none. Throws InputError.
std::vector<LogFinding> findings_from(const ReportReader& object);

}  // namespace gdtslam

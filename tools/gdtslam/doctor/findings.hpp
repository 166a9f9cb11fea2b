// What `gdtslam doctor` found in a log, for people and as JSON. Thread-safe.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "contents.hpp"
#include "engine/io/log_contents.hpp"
#include "engine/runs/streams/log_check.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// All that was found.
struct Findings {
  LogContents contents;
  LogCheck check;
  StepBounds bounds;
  std::optional<OdometryDelay> delay;
  std::vector<LogFinding> faults;
  std::vector<MapCommand> commands;
};

std::string findings_text(const Findings& found, const std::string& log);
nlohmann::ordered_json findings_json(const Findings& found, const std::string& log);

}  // namespace gdtslam

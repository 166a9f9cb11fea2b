// What `gdtslam doctor` says of a log's lines, topics, frames and clocks, and what to type to map it. Thread-safe.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "doctor.hpp"
#include "engine/io/log_contents.hpp"
#include "engine/runs/streams/log_check.hpp"

namespace gdtslam {

/// Kinds of lines, or topics, frames and clocks, and which of them `map` uses; each line with its end.
std::string contents_text(const LogContents& contents, const LogCheck& check);
/// Adds the same to a report.
void add_contents(const LogContents& contents, nlohmann::ordered_json& report);

/// A line to type, and when it is the right one.
struct MapCommand {
  std::string when;
  std::string line;
};
/// What maps the log, the simplest first; with what doctor itself was told, and with the options that mend `faults`.
/// None where it cannot be mapped.
std::vector<MapCommand> map_commands(const DoctorOptions& options, const LogContents& contents, const LogCheck& check,
                                     const std::vector<LogFinding>& faults);

}  // namespace gdtslam

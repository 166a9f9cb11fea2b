// Options of `gdtslam doctor`, and its reports on logs, maps and devices. Thread-safe apart from the files.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/io/log_contents.hpp"
#include "engine/runs/streams/log_check.hpp"
#include "gdtslam/runs/outcome.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {

struct DoctorOptions {
  std::string log;
  RecordingOptions recording;
  SettingsOptions settings;
  std::string after;     ///< folder of a run, instead of a log
  std::string picture;   ///< picture of the run
  bool devices = false;  ///< report devices instead of a log
  bool force = false;
  bool json = false;
};

/// Prints the devices that can compute here; returns the exit code.
int doctor_of_devices(bool json);

/// Prints the doubtful parts of a run's map and draws them if a picture is requested. Returns the exit code, which is 0
/// even if parts are doubtful. Throws InputError, FileError, UsageError, UnavailableError.
int doctor_after(const DoctorOptions& options);

// Description of a log's lines, topics, frames and clocks, and commands that map it. Thread-safe.

/// Kinds of lines, or topics, frames and clocks, and their use by `map`; whole lines.
std::string contents_text(const LogContents& contents, const LogCheck& check);
/// Adds the same to a report.
void add_contents(const LogContents& contents, nlohmann::ordered_json& report);

/// A command line, and when to use it.
struct MapCommand {
  std::string when;
  std::string line;
};
/// Commands that map the log, the simplest first, with doctor's own options and those that correct `faults`. Empty if
/// the log cannot be mapped.
std::vector<MapCommand> map_commands(const DoctorOptions& options, const LogContents& contents, const LogCheck& check,
                                     const std::vector<LogFinding>& faults);

// Findings of `gdtslam doctor` in a log, for people and as JSON. Thread-safe.

/// All findings.
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

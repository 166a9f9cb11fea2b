// The configuration on the command line, -c FILE and --set PATH=VALUE, and what there is to say about a mapped log.
#pragma once

#include <string>
#include <vector>

#include "cli.hpp"
#include "gdtslam/runs/outcome.hpp"
#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

/// The configuration on the command line.
struct SettingsOptions {
  std::string file;               ///< empty: none
  std::vector<std::string> sets;  ///< path=value
};

void add_settings_options(CLI::App& command, SettingsOptions& options);

/// The defaults, then the file, then each --set in turn. Throws ConfigError that names every fault.
Settings load_settings(const SettingsOptions& options);

/// On standard error, each kind on a line of its own.
void print_warnings(const std::vector<LogReader::Warning>& warnings);

/// The warnings, and in a line how many scans are in doubt and where to look: in `folder`, empty where the run is not
/// kept.
void print_remarks(const MapOutcome& outcome, const std::string& folder = "");

/// That line without its end; empty where no scan is in doubt.
std::string doubts_text(const MapOutcome& outcome, const std::string& folder);

}  // namespace gdtslam

// The configuration on the command line (-c FILE and --set PATH=VALUE), and remarks on a mapped log.
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

/// Prints to standard error, one line for each kind.
void print_warnings(const std::vector<LogReader::Warning>& warnings);

/// Prints the warnings, then a line with the number of doubtful scans and where to look: in `folder`, empty if the run
/// is not kept.
void print_remarks(const MapOutcome& outcome, const std::string& folder = "");

/// That line without its line end; empty if no scan is doubtful.
std::string doubts_text(const MapOutcome& outcome, const std::string& folder);

}  // namespace gdtslam

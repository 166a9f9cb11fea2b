// All options of a run with where each value came from: the defaults, then the file of -c, then each --set in turn.
#pragma once

#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "cloud_output.hpp"
#include "gdtslam/calib/nod_track.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "log_config.hpp"

namespace gdtslam {

/// What the command line says about the configuration.
struct SettingsOptions {
  std::string file;               ///< empty: none
  std::vector<std::string> sets;  ///< path=value
};

void add_settings_options(CLI::App& command, SettingsOptions& options);

struct Settings {
  MapperConfig mapper;
  OccupancyConfig occupancy;
  NoddingConfig nodding;
  calib::NodTrackLimits nod_limits;
  CloudConfig cloud;
  LogConfig log;
  std::vector<std::string> from_file;  ///< paths that the file set
  std::vector<std::string> from_sets;  ///< paths that --set set
};

/// The table of every option; its rows point into `settings`.
std::vector<Option> options_of(Settings& settings);

/// Throws ConfigError that names every fault.
Settings load_settings(const SettingsOptions& options);

/// Throws ConfigError that names every violation.
void require_valid(Settings& settings);

}  // namespace gdtslam

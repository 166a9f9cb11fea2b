// All options of a run and the source of each value: the defaults, a file, or single assignments. Thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gdtslam/calib/nod_track.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

enum class CloudRemoval : std::uint8_t { kNone, kFloor, kCeiling, kBoth };

/// Thinning of a cloud, and the parts to leave out.
struct CloudConfig {
  double voxel_m = 0.02;             ///< one point a voxel; 0 keeps all
  std::int32_t max_megavoxels = 64;  ///< memory: 16 to 32 MiB each
  CloudRemoval remove = CloudRemoval::kNone;
  double remove_margin_m = 0.05;  ///< above the floor and below the ceiling
};
/// The table of the options, under "cloud."; its rows point into `config`.
std::vector<Option> option_table(CloudConfig& config);

/// Whether the log's own values are used or the stated ones.
enum class LogSource : std::uint8_t { kLog, kStated };

/// Source of the delay of odometry's stamps after the scans'.
enum class OdometryStamps : std::uint8_t { kMeasured, kStated, kLog };

/// Which of CARMEN's two lasers are read.
enum class LogLasers : std::uint8_t { kFront, kAll };

/// Corrections of wrong values in a log: mount of the laser, bearings of the beams, limit of the ranges, clock of the
/// odometry, counts of a crank (docs/formats.md). Metres, radians.
struct LogConfig {
  LogSource mount = LogSource::kLog;
  Pose2 T_base_laser;  ///< used if `mount` is stated
  LogSource bearings = LogSource::kLog;
  double first_bearing_rad = 0.0;  ///< both are used if `bearings` are stated
  double bearing_step_rad = 0.0;
  double max_range_m = 0.0;  ///< 0: the log's own limit
  LogSource beam_times = LogSource::kLog;
  double first_beam_after_s = 0.0;  ///< both are used if `beam_times` are stated
  double beam_period_s = 0.0;
  bool deskew = true;
  OdometryStamps odometry_stamps = OdometryStamps::kMeasured;
  double odometry_delay_s = 0.0;  ///< used if they are stated
  LogSource clock = LogSource::kLog;
  double clock_offset_s = 0.0;  ///< used if `clock` is stated
  CrankOptions crank;
  TopicChoice topics;  ///< for recordings; not an option, set by --topic, --odom, --crank and --mount
  LogLasers lasers = LogLasers::kFront;
};

/// The options under "log.".
std::vector<Option> option_table(LogConfig& config);

/// Faults that the bounds of the options do not find: unused values, and a step of zero.
std::vector<std::string> find_faults(const LogConfig& config);

/// Options for the reader of a log: only the stated ones; for the rest the log's own values are used.
ReadOptions read_options_of(const LogConfig& config, bool lenient);

/// Every option of a run, and which were set.
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
std::vector<Option> option_table(Settings& settings);

/// Throws ConfigError that names every violation.
void require_valid(Settings& settings);

}  // namespace gdtslam

#include "gdtslam/runs/settings.hpp"

#include <array>
#include <string_view>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

std::vector<Option> option_table(calib::NodTrackLimits& limits) {
  return {{"nod.max_gap",
           "Longest time between two messages of the crank; where they are further apart its position is not known",
           Unit::kSecond, 0.001, 3600.0, &limits.max_gap_s, kAdvanced},
          {"nod.max_turns_per_second",
           "Fastest turning of the crank; where it seems faster it has jumped, and its position is not known there",
           Unit::kNone, 0.01, 1000.0, &limits.max_turns_per_s, kAdvanced}};
}

// The options outside of the 2D mapper.
std::vector<Option> options_besides_mapper(Settings& settings) {
  std::vector<Option> table = option_table(settings.occupancy);
  for (const std::vector<Option>& part : {option_table(settings.nodding), option_table(settings.nod_limits),
                                          option_table(settings.cloud), option_table(settings.log)}) {
    table.insert(table.end(), part.begin(), part.end());
  }
  return table;
}

constexpr std::array<std::string_view, 2> kSourceNames{"log", "stated"};
constexpr std::array<std::string_view, 3> kOdometryStamps{"measured", "stated", "log"};
constexpr std::array<std::string_view, 2> kCrankNames{"ticks", "tilt"};
constexpr double kMostOffset_s = 1.0e10;
constexpr double kMostZero = 1.0e9;
constexpr std::array<std::string_view, 2> kLaserNames{"front", "all"};
constexpr double kMostMount_m = 100.0;
constexpr double kMostAngle_rad = 6.3;
constexpr double kMostRange_m = 1000.0;
constexpr double kLongestScan_s = 10.0;

}  // namespace

std::vector<Option> option_table(Settings& settings) {
  std::vector<Option> table = option_table(settings.mapper);
  const std::vector<Option> others = options_besides_mapper(settings);
  table.insert(table.end(), others.begin(), others.end());
  return table;
}

void require_valid(Settings& settings) {
  std::vector<std::string> faults = validate(settings.mapper);
  for (std::string& fault : violations(options_besides_mapper(settings))) faults.push_back(std::move(fault));
  for (std::string& fault : find_faults(settings.log)) faults.push_back(std::move(fault));
  std::string all;
  for (const std::string& fault : faults) all += (all.empty() ? "" : "; ") + fault;
  if (!all.empty()) throw ConfigError(all);
}

namespace {

/// When beams and odometry were measured.
std::vector<Option> timing_options(LogConfig& config) {
  return {
      {"log.beam_times",
       "When the beams of a scan were measured: as the log says, or stated by log.first_beam_after and log.beam_period",
       Unit::kNone, 0.0, 0.0, Choice(config.beam_times, kSourceNames)},
      {"log.first_beam_after", "Time from the stamp of a scan to its first beam", Unit::kSecond, -kLongestScan_s,
       kLongestScan_s, &config.first_beam_after_s},
      {"log.beam_period", "Time from one beam to the next; negative where the last one was measured first",
       Unit::kSecond, -kLongestScan_s, kLongestScan_s, &config.beam_period_s},
      {"log.deskew", "Whether each beam is placed where the robot was when it was measured", Unit::kNone, 0.0, 1.0,
       &config.deskew},
      {"log.odometry_stamps",
       "Whether odometry is stamped later than the scans that it belongs to: measured at the log's begin, stated by "
       "log.odometry_delay, or right as the log has them",
       Unit::kNone, 0.0, 0.0, Choice(config.odometry_stamps, kOdometryStamps)},
      {"log.odometry_delay",
       "How much later odometry is stamped than the scans that it belongs to; negative where it is earlier",
       Unit::kSecond, -kLongestScan_s, kLongestScan_s, &config.odometry_delay_s}};
}

/// Options for recordings of messages only.
std::vector<Option> recording_options(LogConfig& config) {
  return {{"log.clock",
           "How far the clocks of odometry and crank of a recording are off the laser's: by when their messages were "
           "received, or stated by log.clock_offset",
           Unit::kNone, 0.0, 0.0, Choice(config.clock, kSourceNames), kAdvanced},
          {"log.clock_offset", "What is added to the stamps of odometry and crank of a recording", Unit::kSecond,
           -kMostOffset_s, kMostOffset_s, &config.clock_offset_s, kAdvanced},
          {"log.crank",
           "What the messages of --crank of a recording are: the crank's ticks, or the tilt of the scan plane itself",
           Unit::kNone, 0.0, 0.0, Choice(config.crank.kind, kCrankNames), kAdvanced},
          {"log.crank_step",
           "Angle of one unit of a tilt, or of one tick where the messages are angles; 0 takes a tilt in radians and "
           "whole ticks",
           Unit::kRadian, -kMostAngle_rad, kMostAngle_rad, &config.crank.step_rad, kAdvanced},
          {"log.crank_zero", "What the message of a tilt says when the scan plane is level, in the message's own units",
           Unit::kNone, -kMostZero, kMostZero, &config.crank.zero, kAdvanced}};
}

}  // namespace

std::vector<Option> option_table(LogConfig& config) {
  Pose2& mount = config.T_base_laser;
  std::vector<Option> rows{
      {"log.mount",
       "Where the laser sits on the robot: as each line of the log says, or stated by log.mount_x, log.mount_y and "
       "log.mount_angle",
       Unit::kNone, 0.0, 0.0, Choice(config.mount, kSourceNames)},
      {"log.mount_x", "How far the laser sits ahead of the robot's centre", Unit::kMetre, -kMostMount_m, kMostMount_m,
       &mount.x_m},
      {"log.mount_y", "How far the laser sits to the left of the robot's centre", Unit::kMetre, -kMostMount_m,
       kMostMount_m, &mount.y_m},
      {"log.mount_angle", "Heading of the laser on the robot, counter-clockwise from straight ahead", Unit::kRadian,
       -kMostAngle_rad, kMostAngle_rad, &mount.theta_rad},
      {"log.bearings", "Bearings of the beams: as the log says, or stated by log.first_bearing and log.bearing_step",
       Unit::kNone, 0.0, 0.0, Choice(config.bearings, kSourceNames), kAdvanced},
      {"log.first_bearing", "Bearing of the first beam, counter-clockwise from straight ahead", Unit::kRadian,
       -kMostAngle_rad, kMostAngle_rad, &config.first_bearing_rad, kAdvanced},
      {"log.bearing_step", "Angle from one beam to the next; negative where the laser hangs upside down", Unit::kRadian,
       -kMostAngle_rad, kMostAngle_rad, &config.bearing_step_rad, kAdvanced},
      {"log.max_range",
       "Limit of the sensor, at or above which a range is no return; 0 takes what the log says, or a constant below "
       "that which stands for no return",
       Unit::kMetre, 0.0, kMostRange_m, &config.max_range_m},
      {"log.lasers",
       "Lasers of a CARMEN log that are taken: the front one, or all, with RLASER and ROBOTLASER2 as a second one",
       Unit::kNone, 0.0, 0.0, Choice(config.lasers, kLaserNames)}};
  for (const std::vector<Option>& part : {timing_options(config), recording_options(config)}) {
    rows.insert(rows.end(), part.begin(), part.end());
  }
  return rows;
}

std::vector<std::string> find_faults(const LogConfig& config) {
  std::vector<std::string> faults;
  const Pose2& mount = config.T_base_laser;
  if (config.mount == LogSource::kLog && (mount.x_m != 0.0 || mount.y_m != 0.0 || mount.theta_rad != 0.0)) {
    faults.emplace_back("log.mount_x, log.mount_y and log.mount_angle count only with log.mount: stated");
  }
  if (config.bearings == LogSource::kLog && (config.first_bearing_rad != 0.0 || config.bearing_step_rad != 0.0)) {
    faults.emplace_back("log.first_bearing and log.bearing_step count only with log.bearings: stated");
  }
  if (config.beam_times == LogSource::kLog && (config.first_beam_after_s != 0.0 || config.beam_period_s != 0.0)) {
    faults.emplace_back("log.first_beam_after and log.beam_period count only with log.beam_times: stated");
  }
  if (config.odometry_stamps != OdometryStamps::kStated && config.odometry_delay_s != 0.0) {
    faults.emplace_back("log.odometry_delay counts only with log.odometry_stamps: stated");
  }
  if (config.bearings == LogSource::kStated && config.bearing_step_rad == 0.0) {
    faults.emplace_back("log.bearing_step: stated bearings need a step that is not 0, for example 0.5 deg");
  }
  if (config.clock == LogSource::kLog && config.clock_offset_s != 0.0) {
    faults.emplace_back("log.clock_offset counts only with log.clock: stated");
  }
  if (config.crank.kind == CrankKind::kTicks && config.crank.zero != 0.0) {
    faults.emplace_back("log.crank_zero counts only with log.crank: tilt");
  }
  return faults;
}

ReadOptions read_options_of(const LogConfig& config, bool lenient) {
  ReadOptions options{.lenient = lenient};
  options.topics = config.topics;
  options.crank = config.crank;
  if (config.clock == LogSource::kStated) options.clock_offset_s = config.clock_offset_s;
  if (config.mount == LogSource::kStated) options.T_base_laser = config.T_base_laser;
  if (config.bearings == LogSource::kStated) {
    options.first_bearing_rad = config.first_bearing_rad;
    options.bearing_step_rad = config.bearing_step_rad;
  }
  if (config.beam_times == LogSource::kStated) {
    options.first_beam_after_s = config.first_beam_after_s;
    options.beam_period_s = config.beam_period_s;
  }
  options.deskew = config.deskew;
  options.all_lasers = config.lasers == LogLasers::kAll;
  if (config.max_range_m > 0.0) options.max_range_m = config.max_range_m;
  return options;
}

}  // namespace gdtslam

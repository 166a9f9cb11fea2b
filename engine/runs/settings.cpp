#include "gdtslam/runs/settings.hpp"

#include <array>
#include <string_view>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

std::vector<Option> option_table(calib::NodTrackLimits& limits) {
  return {{"nod.max_gap", "between two messages of the crank that are further apart its position is not known",
           Unit::kSecond, 0.001, 3600.0, &limits.max_gap_s},
          {"nod.max_turns_per_second", "a crank that seems faster has jumped: not known between the two messages",
           Unit::kNone, 0.01, 1000.0, &limits.max_turns_per_s}};
}

// The options that are no concern of the 2D system.
std::vector<Option> options_besides_mapper(Settings& settings) {
  std::vector<Option> table = option_table(settings.occupancy);
  for (const std::vector<Option>& part : {option_table(settings.nodding), option_table(settings.nod_limits),
                                          option_table(settings.cloud), option_table(settings.log)}) {
    table.insert(table.end(), part.begin(), part.end());
  }
  return table;
}

constexpr std::array<std::string_view, 2> kSourceNames{"log", "stated"};
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
  for (std::string& fault : faults_of(settings.log)) faults.push_back(std::move(fault));
  std::string all;
  for (const std::string& fault : faults) all += (all.empty() ? "" : "; ") + fault;
  if (!all.empty()) throw ConfigError(all);
}

std::vector<Option> option_table(LogConfig& config) {
  Pose2& mount = config.T_base_laser;
  return {{"log.mount", "where the laser sits on the robot: by each line of the log, or stated by the next three",
           Unit::kNone, 0.0, 0.0, Choice(config.mount, kSourceNames)},
          {"log.mount_x", "the laser's place ahead of the robot's centre", Unit::kMetre, -kMostMount_m, kMostMount_m,
           &mount.x_m},
          {"log.mount_y", "and to its left", Unit::kMetre, -kMostMount_m, kMostMount_m, &mount.y_m},
          {"log.mount_angle", "and its heading there, counter-clockwise", Unit::kRadian, -kMostAngle_rad,
           kMostAngle_rad, &mount.theta_rad},
          {"log.bearings", "bearings of the beams: by the log, or stated by the next two", Unit::kNone, 0.0, 0.0,
           Choice(config.bearings, kSourceNames)},
          {"log.first_bearing", "of the first beam, counter-clockwise from straight ahead", Unit::kRadian,
           -kMostAngle_rad, kMostAngle_rad, &config.first_bearing_rad},
          {"log.bearing_step", "from beam to beam; negative where the laser hangs upside down", Unit::kRadian,
           -kMostAngle_rad, kMostAngle_rad, &config.bearing_step_rad},
          {"log.max_range", "the sensor's limit, at or above which a range is no return; 0: what the log says",
           Unit::kMetre, 0.0, kMostRange_m, &config.max_range_m},
          {"log.lasers", "of a CARMEN log: the front laser alone, or all: RLASER and ROBOTLASER2 as a second one too",
           Unit::kNone, 0.0, 0.0, Choice(config.lasers, kLaserNames)},
          {"log.beam_times", "when the beams were measured: by the log, or stated by the next two", Unit::kNone, 0.0,
           0.0, Choice(config.beam_times, kSourceNames)},
          {"log.first_beam_after", "of the first beam, after the scan's stamp", Unit::kSecond, -kLongestScan_s,
           kLongestScan_s, &config.first_beam_after_s},
          {"log.beam_period", "from beam to beam; negative where the last one was measured first", Unit::kSecond,
           -kLongestScan_s, kLongestScan_s, &config.beam_period_s},
          {"log.deskew", "place each beam where the robot was when it was measured", Unit::kNone, 0.0, 1.0,
           &config.deskew}};
}

std::vector<std::string> faults_of(const LogConfig& config) {
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
  if (config.bearings == LogSource::kStated && config.bearing_step_rad == 0.0) {
    faults.emplace_back("log.bearing_step: stated bearings need a step that is not 0, for example 0.5 deg");
  }
  return faults;
}

ReadOptions read_options_of(const LogConfig& config, bool lenient, const std::string& topic) {
  ReadOptions options{.lenient = lenient};
  options.topic = topic;
  if (config.mount == LogSource::kStated) options.T_base_laser = config.T_base_laser;
  if (config.bearings == LogSource::kStated) {
    options.first_bearing_rad = config.first_bearing_rad;
    options.bearing_step_rad = config.bearing_step_rad;
  }
  options.all_lasers = config.lasers == LogLasers::kAll;
  if (config.beam_times == LogSource::kStated) {
    options.first_beam_after_s = config.first_beam_after_s;
    options.beam_period_s = config.beam_period_s;
  }
  options.deskew = config.deskew;
  if (config.max_range_m > 0.0) options.max_range_m = config.max_range_m;
  return options;
}

}  // namespace gdtslam

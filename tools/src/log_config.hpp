// What an option may state of a log's laser where the log itself is wrong about it: the mount, the bearings of the
// beams, the limit of the ranges (docs/formats.md, CARMEN logs). Metres, radians. Thread-safe.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/io/read_options.hpp"
#include "gdtslam/mapping/option.hpp"

namespace gdtslam {

/// Whether the log's own lines are believed or the values beside it.
enum class LogSource : std::uint8_t { kLog, kStated };

struct LogConfig {
  LogSource mount = LogSource::kLog;
  Pose2 T_base_laser;  ///< counts where `mount` is stated
  LogSource bearings = LogSource::kLog;
  double first_bearing_rad = 0.0;  ///< both count where `bearings` are stated
  double bearing_step_rad = 0.0;
  double max_range_m = 0.0;  ///< 0: what the log says
};

std::vector<Option> options_of(LogConfig& config);

/// What the bounds of the options do not tell: values that nothing would use, and a step of zero.
std::vector<std::string> faults_of(const LogConfig& config);

ReadOptions read_options_of(const LogConfig& config, bool lenient);

}  // namespace gdtslam

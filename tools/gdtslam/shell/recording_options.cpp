#include "recording_options.hpp"

#include <fmt/format.h>
#include <CLI/App.hpp>

#include <array>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/units.hpp"
#include "options.hpp"

namespace gdtslam {
namespace {

Pose2 mount_of(const std::string& text) {
  std::array<std::string, 3> parts;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const std::size_t comma = text.find(',', begin);
    if ((comma == std::string::npos) != (k + 1 == parts.size())) {
      throw UsageError(fmt::format("--mount: '{}' is no x,y,yaw, for example 0.2m,0,180deg", text));
    }
    parts[k] = text.substr(begin, comma - begin);
    begin = comma + 1;
  }
  return {quantity_of("--mount", parts[0], Unit::kMetre), quantity_of("--mount", parts[1], Unit::kMetre),
          quantity_of("--mount", parts[2], Unit::kRadian)};
}

}  // namespace

void add_recording_options(CLI::App& command, RecordingOptions& options) {
  command
      .add_option("--topic", options.topics,
                  "Topic of the scans of a recording, once for each laser, or 'all' [the only one that has any]")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command
      .add_option("--odom", options.odometry,
                  "Topic of the odometry of a recording, or tf [the first one, else the transforms]")
      ->type_name("NAME");
  command
      .add_option("--crank", options.crank,
                  "Topic of the crank of a nodding mount in a recording; log.crank says what it counts")
      ->type_name("NAME[:JOINT]");
  command
      .add_option("--mount", options.mounts,
                  "Where the laser sits on the robot: x,y,yaw; of one of several lasers NAME=x,y,yaw; short for\n"
                  "log.mount [what the log says]")
      ->type_name("X,Y,YAW")
      ->allow_extra_args(false);
}

void state_recording(const RecordingOptions& options, LogConfig& config) {
  config.topics.scans = options.topics;
  config.topics.odometry = options.odometry;
  config.topics.crank = options.crank;
  for (const std::string& text : options.mounts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      config.mount = LogSource::kStated;
      config.T_base_laser = mount_of(text);
    } else {
      config.topics.mounts.push_back({text.substr(0, equals), mount_of(text.substr(equals + 1))});
    }
  }
}

}  // namespace gdtslam

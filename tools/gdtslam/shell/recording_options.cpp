#include "recording_options.hpp"

#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <array>
#include <vector>

#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/units.hpp"
#include "options.hpp"

namespace gdtslam {
namespace {

Pose2 parse_mount(const std::string& text) {
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
  LogConfig stated;  // its options hold the bounds of a mount
  stated.T_base_laser = {quantity_of("--mount", parts[0], Unit::kMetre), quantity_of("--mount", parts[1], Unit::kMetre),
                         quantity_of("--mount", parts[2], Unit::kRadian)};
  if (const std::vector<std::string> faults = violations(option_table(stated)); !faults.empty()) {
    throw UsageError("--mount: " + faults.front());
  }
  return stated.T_base_laser;
}

/// The topic of NAME=x,y,yaw, with or without its slash; empty if there is none.
std::string mount_topic(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return {};
  const std::size_t slash = text.starts_with('/') ? 1 : 0;
  return text.substr(slash, equals - slash);
}

void require_one_mount_each(const std::vector<std::string>& mounts) {
  std::vector<std::string> topics;
  for (const std::string& text : mounts) {
    const std::string topic = mount_topic(text);
    if (std::find(topics.begin(), topics.end(), topic) != topics.end()) {
      throw UsageError(topic.empty() ? "--mount: of several lasers each is named: NAME=x,y,yaw"
                                     : fmt::format("--mount: {} is given twice", in_quotes(topic)));
    }
    topics.push_back(topic);
  }
}

}  // namespace

void add_recording_options(CLI::App& command, RecordingOptions& options) {
  command
      .add_option("--topic", options.topics,
                  "Topic of the scans of a recording, once for each laser, or 'all' [the only one that has any]")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command
      .add_option(
          "--odom", options.odometry,
          "Topic of the odometry of a recording, or tf: the transform from FRAME to BASE [the first topic, else\n"
          "the transform from a frame with odom in its name]")
      ->type_name("NAME|tf[:FRAME[:BASE]]");
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
  require_one_mount_each(options.mounts);
  for (const std::string& text : options.mounts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      config.mount = LogSource::kStated;
      config.T_base_laser = parse_mount(text);
    } else {
      config.topics.mounts.push_back({text.substr(0, equals), parse_mount(text.substr(equals + 1))});
    }
  }
}

}  // namespace gdtslam

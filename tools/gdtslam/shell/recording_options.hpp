// Which topics of a recording (ROS bag, MCAP) are read, and where the lasers sit, on the command line. Thread-safe.
#pragma once

#include <string>
#include <vector>

#include "cli.hpp"
#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

struct RecordingOptions {
  std::vector<std::string> topics;
  std::string odometry;
  std::string crank;
  std::vector<std::string> mounts;  ///< x,y,yaw or TOPIC=x,y,yaw
  [[nodiscard]] bool are_stated() const {
    return !topics.empty() || !odometry.empty() || !crank.empty() || !mounts.empty();
  }
};

/// --topic, --odom, --crank, --mount.
void add_recording_options(CLI::App& command, RecordingOptions& options);

/// States them in the configuration: a mount without a topic as log.mount. Throws UsageError for what is no mount,
/// lies beyond the bounds of log.mount_*, or is stated twice.
void state_recording(const RecordingOptions& options, LogConfig& config);

}  // namespace gdtslam

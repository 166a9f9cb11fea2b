// Command-line options of recordings (ROS bag, MCAP): topics to read, and mounts of the lasers. Thread-safe.
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

/// Adds --topic, --odom, --crank, --mount.
void add_recording_options(CLI::App& command, RecordingOptions& options);

/// Writes them into the configuration: a mount without a topic as log.mount. Throws UsageError for a text that is no
/// mount, lies beyond the bounds of log.mount_*, or is given twice.
void state_recording(const RecordingOptions& options, LogConfig& config);

}  // namespace gdtslam

// A run as an MCAP file of ROS 2 messages for viewers (Foxglove, rerun): /map nav_msgs/OccupancyGrid, /pose
// geometry_msgs/PoseStamped and /scan sensor_msgs/LaserScan of every scan, /tf from map to base_link, /tf_static from
// base_link to the laser; so scans are drawn where they are in the map. Reads the logs again. Not thread-safe; linear
// in the logs, memory a chunk and the grid.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/io/log.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// Atomic. The logs, options and range are those of the run that gave the outcome. Throws FileError, InputError; the
/// number of scans that were left out because ROS knows no such stamp is the result.
std::size_t write_run_recording(const std::string& file, const std::vector<std::string>& logs,
                                const ReadOptions& options, const ScanRange& range, const MapOutcome& outcome);

}  // namespace gdtslam

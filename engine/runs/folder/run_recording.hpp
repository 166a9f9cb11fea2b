// A run as an MCAP file of ROS 2 messages for viewers (Foxglove, rerun): /map nav_msgs/OccupancyGrid, /pose
// geometry_msgs/PoseStamped and /scan sensor_msgs/LaserScan of every scan, /tf from map to base_link, /tf_static from
// base_link to the laser; so viewers draw scans at their places in the map. Reads the logs again. Not thread-safe;
// linear in the logs, memory for a chunk and the grid.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/io/log.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// Atomic. The logs, options and range must be those of the outcome's run. Returns the number of scans left out because
/// ROS cannot express their stamps. Throws FileError, InputError.
std::size_t write_run_recording(const std::string& file, const std::vector<std::string>& logs,
                                const ReadOptions& options, const ScanRange& range, const MapOutcome& outcome);

}  // namespace gdtslam

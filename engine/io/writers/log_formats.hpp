// Writers of the formats; make_log_writer() (log_writer.hpp) chooses one. `file` must outlive them.
#pragma once

#include "log_writer.hpp"

namespace gdtslam {

/// Lines of CARMEN. A scan without odometry gets the pose of the previous odometry record.
std::unique_ptr<LogWriter> make_carmen_log(AtomicFile& file);
/// Rows of CSV. Every number has the shortest form that reads back as the same bits, so that a log gives the same map.
std::unique_ptr<LogWriter> make_csv_log(AtomicFile& file);
/// Lines of JSON, with the same numbers.
std::unique_ptr<LogWriter> make_json_lines_log(AtomicFile& file);
/// ROS messages: /scan (and /scan_2, ... for further lasers) sensor_msgs/LaserScan, /odom nav_msgs/Odometry, /tf from
/// odom to base_link, /tf_static from base_link to the laser, /crank std_msgs/Int32, /tilt sensor_msgs/JointState. The
/// odometry of a scan is a message of its stamp just before it.
std::unique_ptr<LogWriter> make_ros_log(AtomicFile& file, ChunkPacking packing);

}  // namespace gdtslam

// Reader of recordings of robots' messages (ROS bags, MCAP; docs/formats.md): sensor_msgs/LaserScan with
// nav_msgs/Odometry or else the transform from odom to the robot, joined by the stamps of their headers. Memory is
// bounded by the largest message allowed (16 MiB), 64 scans and the window of a packed chunk. One reader belongs to one
// thread.
#pragma once

#include <memory>
#include <string>

#include "engine/io/byte_source.hpp"
#include "engine/io/log_contents.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// A ROS 1 bag from an unpacked source, at its first byte; `name` is for messages. next() throws UsageError if several
/// topics have scans and ReadOptions::topics names none of them; InputError if the recording is damaged (with
/// ReadOptions::lenient a damaged message is left out, and other damage ends the log) or has no scan.
std::unique_ptr<DescribedLog> open_bag(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                       const ReadOptions& options);
/// An MCAP file, read in the same way.
std::unique_ptr<DescribedLog> open_mcap(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                        const ReadOptions& options);

/// A ROS 2 bag: its folder, or one file of it (SQLite), packed or not.
std::unique_ptr<DescribedLog> open_ros2_bag(const std::string& path, const ReadOptions& options);

}  // namespace gdtslam

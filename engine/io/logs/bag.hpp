// Reader of ROS 1 bags (format 2.0; docs/formats.md): sensor_msgs/LaserScan with nav_msgs/Odometry or, where there is
// none, the transform from odom to the robot, joined by the stamps of their headers. Forward only: a pipe, a bag
// without index and one that was cut off are read as far as they go. Memory is bounded by the largest message allowed
// (16 MiB) and 64 scans. One reader belongs to one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "engine/io/byte_source.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {

/// A bag out of a source that was unpacked already, from its first byte. next() throws UsageError where several topics
/// have scans and ReadOptions::topic names none of them; InputError where the bag is damaged (with
/// ReadOptions::lenient chunks and messages that are damaged are counted instead) or has no scan.
std::unique_ptr<LogReader> open_bag(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                    const ReadOptions& options);

/// A bag in memory, which must outlive the reader; `name` stands in messages.
std::unique_ptr<LogReader> open_bag(std::span<const std::byte> data, const std::string& name,
                                    const ReadOptions& options);

}  // namespace gdtslam

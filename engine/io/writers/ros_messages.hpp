// ROS 2 messages as bytes in CDR (little endian), and the names and fields of their types. Metres, radians, seconds.
// Thread-safe; linear in the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

enum class RosType : std::uint8_t {
  kLaserScan,
  kOdometry,
  kTransforms,
  kInt32,
  kJointState,
  kPoseStamped,
  kOccupancyGrid
};

/// "sensor_msgs/msg/LaserScan".
std::string ros_type_name(RosType type);
/// The fields of the type and of all types in it, in the form of MCAP files.
std::string ros_definition(RosType type);

/// Nanoseconds since the epoch; the stamp must be at least 0 and below kRosStampLimit_s.
std::int64_t ros_time_ns(double stamp_s);
/// ROS 2 has 31 bits for seconds.
inline constexpr double kRosStampLimit_s = 2147483648.0;

struct RosStamp {
  double stamp_s = 0.0;
  std::string_view frame;
};
struct RosTransform {
  RosStamp parent;
  std::string_view child;
  Pose2 T_parent_child;
};
struct RosSpeed {
  double forward_m_per_s = 0.0;
  double turn_rad_per_s = 0.0;
};
/// A grid seen from above, row by row from its origin: 0 free to 100 occupied, -1 unknown.
struct RosGrid {
  double resolution_m = 0.0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Pose2 T_map_origin;  ///< pose of the corner of its first cell
  std::span<const std::int8_t> cells;
};

/// The stamp of its message: the time of the beam measured first.
double ros_scan_stamp_s(const LaserScan& scan);
// Writes beams in the order of measurement, as in ROS, and an unknown limit as infinity.
std::string ros_laser_scan(const LaserScan& scan, std::string_view frame, double scan_time_s);
std::string ros_odometry(const RosTransform& pose, const RosSpeed& speed);
std::string ros_transforms(std::span<const RosTransform> transforms);
std::string ros_int32(std::int32_t value);
std::string ros_joint_state(const RosStamp& stamp, std::string_view joint, double position);
std::string ros_pose(const RosStamp& stamp, const Pose2& pose);
std::string ros_occupancy_grid(const RosStamp& stamp, const RosGrid& grid);

}  // namespace gdtslam

// ROS messages as bytes, in the serialisation of ROS 1 or in the CDR of ROS 2 (little endian), and what their types are
// called and made of. Metres, radians, seconds. Thread-safe; linear in the bytes.
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

enum class RosEncoding : std::uint8_t { kRos1, kCdr };
enum class RosType : std::uint8_t {
  kLaserScan,
  kOdometry,
  kTransforms,
  kInt32,
  kJointState,
  kPoseStamped,
  kOccupancyGrid
};

/// "sensor_msgs/LaserScan" in ROS 1, "sensor_msgs/msg/LaserScan" in ROS 2.
std::string ros_type_name(RosType type, RosEncoding encoding);
/// The fields of the type and of all types in it, as bags and MCAP files carry them.
std::string ros_definition(RosType type, RosEncoding encoding);
/// Of ROS 1: the MD5 sum by which a reader knows the type.
std::string_view ros_md5(RosType type);

/// Nanoseconds since the epoch; the stamp must be at least 0 and below kRosStampLimit_s.
std::int64_t ros_time_ns(double stamp_s);
/// ROS 1 has 32 bits for seconds, ROS 2 31.
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
  Pose2 T_map_origin;  ///< of the corner of its first cell
  std::span<const std::int8_t> cells;
};

/// The stamp of its message: when the beam was measured that came first.
double ros_scan_stamp_s(const LaserScan& scan);
// Beams are written in the order in which they were measured, as ROS has them; a limit that is not known as infinity.
std::string ros_laser_scan(RosEncoding encoding, const LaserScan& scan, std::string_view frame, double scan_time_s);
std::string ros_odometry(RosEncoding encoding, const RosTransform& pose, const RosSpeed& speed);
std::string ros_transforms(RosEncoding encoding, std::span<const RosTransform> transforms);
std::string ros_int32(RosEncoding encoding, std::int32_t value);
std::string ros_joint_state(RosEncoding encoding, const RosStamp& stamp, std::string_view joint, double position);
std::string ros_pose(RosEncoding encoding, const RosStamp& stamp, const Pose2& pose);
std::string ros_occupancy_grid(RosEncoding encoding, const RosStamp& stamp, const RosGrid& grid);

}  // namespace gdtslam

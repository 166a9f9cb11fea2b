// The messages of ROS 1 that a map needs, out of their bytes: sensor_msgs/LaserScan, nav_msgs/Odometry,
// tf2_msgs/TFMessage. Metres, radians, seconds. Thread-safe; linear in the bytes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

enum class BagMessage : std::uint8_t { kOther, kScan, kOdometry, kTransforms };
/// By the type's name or, where a bag has none, by its MD5 sum.
BagMessage bag_message_of(std::string_view type, std::string_view md5);

/// A rotation and a shift in space: points of the child in the parent.
struct Transform3 {
  std::array<double, 9> rotation{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};  ///< row-major
  std::array<double, 3> shift_m{};
  [[nodiscard]] bool is_finite() const;
};
Transform3 operator*(const Transform3& a, const Transform3& b);
/// As seen from above: position, and where the x axis points.
Pose2 seen_from_above(const Transform3& transform);

struct BagScan {
  double stamp_s = 0.0;
  std::string frame;
  double first_bearing_rad = 0.0;
  double bearing_step_rad = 0.0;  ///< below 0 where the laser turns clockwise
  double min_range_m = 0.0;
  double max_range_m = 0.0;
  std::vector<float> ranges_m;  ///< as the message has them
};
struct BagTransform {
  double stamp_s = 0.0;
  std::string parent;  ///< frames without a leading slash
  std::string child;
  Transform3 T_parent_child;
};

// Each throws BagFault where the bytes end too early or contradict themselves.
BagScan bag_scan(std::string_view bytes);
BagTransform bag_odometry(std::string_view bytes);
std::vector<BagTransform> bag_transforms(std::string_view bytes);

}  // namespace gdtslam

// The types of the messages: names and fields, as the ROS 2 packages publish them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <string>
#include <string_view>
#include <vector>

#include "ros_messages.hpp"

namespace gdtslam {
namespace {

/// A type; its fields name other types with their packages.
struct RosPart {
  std::string_view package;
  std::string_view name;
  std::string_view fields;
};

constexpr std::array<RosPart, 19> kRosParts{
    {{"std_msgs", "Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
     {"builtin_interfaces", "Time", "int32 sec\nuint32 nanosec\n"},
     {"geometry_msgs", "Point", "float64 x\nfloat64 y\nfloat64 z\n"},
     {"geometry_msgs", "Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
     {"geometry_msgs", "Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
     {"geometry_msgs", "Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
     {"geometry_msgs", "Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
     {"geometry_msgs", "PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
     {"geometry_msgs", "TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"},
     {"geometry_msgs", "Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
     {"geometry_msgs", "TransformStamped",
      "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
     {"nav_msgs", "MapMetaData",
      "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n"
      "geometry_msgs/Pose origin\n"},
     {"sensor_msgs", "LaserScan",
      "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
      "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n"
      "float32[] intensities\n"},
     {"nav_msgs", "Odometry",
      "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
      "geometry_msgs/TwistWithCovariance twist\n"},
     {"tf2_msgs", "TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
     {"std_msgs", "Int32", "int32 data\n"},
     {"sensor_msgs", "JointState",
      "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"},
     {"geometry_msgs", "PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
     {"nav_msgs", "OccupancyGrid", "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n"}}};

const RosPart& find_part(std::string_view name) {
  const auto* const found =
      std::find_if(kRosParts.begin(), kRosParts.end(), [name](const RosPart& part) { return part.name == name; });
  assert(found != kRosParts.end());
  return *found;
}

std::string_view short_name(RosType type) {
  constexpr std::array<std::string_view, 7> kRosTypeNames{"LaserScan",  "Odometry",    "TFMessage",    "Int32",
                                                          "JointState", "PoseStamped", "OccupancyGrid"};
  return kRosTypeNames[static_cast<std::size_t>(type)];
}

void append_part(const RosPart& part, std::vector<std::string_view>& done, std::string& text) {
  for (std::size_t slash = 0; (slash = part.fields.find('/', slash)) != std::string_view::npos; ++slash) {
    const std::string_view rest = part.fields.substr(slash + 1);
    const std::string_view name = rest.substr(0, rest.find_first_of(" ["));
    if (std::find(done.begin(), done.end(), name) != done.end()) continue;
    done.push_back(name);
    const RosPart& below = find_part(name);
    text += fmt::format("{:=<80}\nMSG: {}/{}\n{}", "", below.package, name, below.fields);
    append_part(below, done, text);
  }
}

}  // namespace

std::string ros_type_name(RosType type) {
  const RosPart& part = find_part(short_name(type));
  return std::string(part.package) + "/msg/" + std::string(part.name);
}

std::string ros_definition(RosType type) {
  const RosPart& part = find_part(short_name(type));
  std::string text(part.fields);
  std::vector<std::string_view> done;
  append_part(part, done, text);
  return text;
}

}  // namespace gdtslam

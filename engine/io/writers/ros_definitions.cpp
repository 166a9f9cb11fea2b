// The types of the messages: names, MD5 sums and fields, as the ROS packages publish them.
#include <algorithm>
#include <array>
#include <cassert>
#include <string>
#include <string_view>
#include <vector>

#include "ros_messages.hpp"

namespace gdtslam {
namespace {

/// A type that others are made of; `time` stands where ROS 2 writes builtin_interfaces/Time.
struct RosPart {
  std::string_view package;
  std::string_view name;
  std::string_view fields;
  std::vector<std::string_view> parts{};  ///< the names of those it is made of
};

const std::array<RosPart, 19>& ros_parts() {
  static const std::array<RosPart, 19> parts{
      {{"std_msgs", "Header", "time stamp\nstring frame_id\n", {"Time"}},
       {"builtin_interfaces", "Time", "int32 sec\nuint32 nanosec\n"},
       {"geometry_msgs", "Point", "float64 x\nfloat64 y\nfloat64 z\n"},
       {"geometry_msgs", "Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
       {"geometry_msgs", "Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
       {"geometry_msgs",
        "Pose",
        "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
        {"Point", "Quaternion"}},
       {"geometry_msgs", "Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n", {"Vector3"}},
       {"geometry_msgs", "PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n", {"Pose"}},
       {"geometry_msgs", "TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n", {"Twist"}},
       {"geometry_msgs",
        "Transform",
        "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
        {"Vector3", "Quaternion"}},
       {"geometry_msgs",
        "TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
        {"Header", "Transform"}},
       {"nav_msgs",
        "MapMetaData",
        "time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\ngeometry_msgs/Pose origin\n",
        {"Time", "Pose"}},
       {"sensor_msgs",
        "LaserScan",
        "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
        "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n"
        "float32[] intensities\n",
        {"Header"}},
       {"nav_msgs",
        "Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
        "geometry_msgs/TwistWithCovariance twist\n",
        {"Header", "PoseWithCovariance", "TwistWithCovariance"}},
       {"tf2_msgs", "TFMessage", "geometry_msgs/TransformStamped[] transforms\n", {"TransformStamped"}},
       {"std_msgs", "Int32", "int32 data\n"},
       {"sensor_msgs",
        "JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
        {"Header"}},
       {"geometry_msgs", "PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n", {"Header", "Pose"}},
       {"nav_msgs",
        "OccupancyGrid",
        "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n",
        {"Header", "MapMetaData"}}}};
  return parts;
}

const RosPart& part_called(std::string_view name) {
  const auto* const found =
      std::find_if(ros_parts().begin(), ros_parts().end(), [name](const RosPart& part) { return part.name == name; });
  assert(found != ros_parts().end());
  return *found;
}

std::string_view short_name(RosType type) {
  constexpr std::array<std::string_view, 7> kRosTypeNames{"LaserScan",  "Odometry",    "TFMessage",    "Int32",
                                                          "JointState", "PoseStamped", "OccupancyGrid"};
  return kRosTypeNames[static_cast<std::size_t>(type)];
}

/// The fields in the words of ROS 1 or ROS 2.
std::string fields_of(const RosPart& part, RosEncoding encoding) {
  std::string text(part.fields);
  if (encoding == RosEncoding::kRos1) return (part.name == "Header" ? "uint32 seq\n" : "") + text;
  if (const std::size_t at = text.find("time "); at == 0 || (at != std::string::npos && text[at - 1] == '\n')) {
    text.replace(at, 4, "builtin_interfaces/Time");
  }
  return text;
}

void append_part(const RosPart& part, RosEncoding encoding, std::vector<std::string_view>& done, std::string& text) {
  for (const std::string_view name : part.parts) {
    const bool is_known = std::find(done.begin(), done.end(), name) != done.end();
    if (is_known || (name == "Time" && encoding == RosEncoding::kRos1)) continue;
    done.push_back(name);
    const RosPart& below = part_called(name);
    text += std::string(80, '=') + "\nMSG: " + std::string(below.package) + "/" + std::string(name) + "\n" +
            fields_of(below, encoding);
    append_part(below, encoding, done, text);
  }
}

}  // namespace

std::string ros_type_name(RosType type, RosEncoding encoding) {
  const RosPart& part = part_called(short_name(type));
  return std::string(part.package) + (encoding == RosEncoding::kRos1 ? "/" : "/msg/") + std::string(part.name);
}

std::string ros_definition(RosType type, RosEncoding encoding) {
  const RosPart& part = part_called(short_name(type));
  std::string text = fields_of(part, encoding);
  std::vector<std::string_view> done;
  append_part(part, encoding, done, text);
  return text;
}

std::string_view ros_md5(RosType type) {
  constexpr std::array<std::string_view, 7> kSums{
      "90c7ef2dc6895d81024acba2ac42f369", "cd5e73d190d741a2f92e81eda573aca7", "94810edda583a504dfda3829e70d7eec",
      "da5909fbe378aeaf85e547e830cc1bb7", "3066dcd76a6cfaef579bd0f34173e9fd", "d3812c3cbc69362b77dc0b19b345f8f5",
      "3381f2d731d4076ec5c71b0759edbe4e"};
  return kSums[static_cast<std::size_t>(type)];
}

}  // namespace gdtslam

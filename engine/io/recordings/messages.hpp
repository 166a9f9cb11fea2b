// Decodes the messages that a map needs, of ROS 1 and ROS 2. Metres, radians, seconds. Thread-safe; linear in the
// bytes. Each throws RecordingFault if the bytes end too early or contradict themselves.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "containers/recording.hpp"
#include "transform3.hpp"

namespace gdtslam {

enum class MessageKind : std::uint8_t { kOther, kScan, kEchoScan, kOdometry, kTransforms, kJoints, kNumber };
/// By the type's name, with or without /msg/, or by its MD5 sum if a bag has no name; kOther for an unsupported
/// encoding.
MessageKind message_kind(const RecordingChannel& channel);
/// The topic of transforms that move.
inline constexpr std::string_view kTransformTopic = "/tf";
inline constexpr std::string_view kStaticTransforms =
    "tf_static";  ///< end of the names of topics with static transforms
/// pkg/Type of pkg/msg/Type.
std::string short_type(std::string_view type);

/// The bytes of a message and their encoding.
struct MessageBytes {
  std::string_view bytes;
  MessageEncoding encoding = MessageEncoding::kRos1;
};

struct ScanMessage {
  double stamp_s = 0.0;
  std::string frame;
  double first_bearing_rad = 0.0;
  double bearing_step_rad = 0.0;  ///< below 0 if the laser turns clockwise
  double beam_period_s = 0.0;     ///< from beam to beam; 0 if not stated
  double min_range_m = 0.0;
  double max_range_m = 0.0;
  std::vector<float> ranges_m;  ///< unchanged from the message
};
struct TransformMessage {
  double stamp_s = 0.0;
  std::string parent;  ///< frames without a leading slash
  std::string child;
  Transform3 T_parent_child;
};
/// A joint, or a number without a name.
struct NumberMessage {
  double stamp_s = 0.0;                 ///< 0: the message has none
  double value = 0.0;                   ///< radians for a joint; for a number, its own unit
  std::optional<std::int64_t> whole{};  ///< every digit of a whole number
};

/// sensor_msgs/LaserScan.
ScanMessage read_scan(const MessageBytes& message);
/// sensor_msgs/MultiEchoLaserScan: the first echo of each beam.
ScanMessage read_echo_scan(const MessageBytes& message);
/// nav_msgs/Odometry.
TransformMessage read_odometry(const MessageBytes& message);
/// tf2_msgs/TFMessage, tf/tfMessage.
std::vector<TransformMessage> read_transforms(const MessageBytes& message);
/// sensor_msgs/JointState: the joint of that name; the first one if it is empty.
NumberMessage read_joint(const MessageBytes& message, std::string_view joint);
/// std_msgs/Int8 to Int64, UInt8 to UInt64, Float32, Float64; `type` is the type's name.
NumberMessage read_number(const MessageBytes& message, std::string_view type);

}  // namespace gdtslam

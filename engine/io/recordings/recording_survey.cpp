#include "recording_survey.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "engine/core/elementary.hpp"
#include "message_cursor.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostFramesOfTopic = 4;
constexpr std::size_t kMostJoints = 16;
constexpr std::size_t kLongestNameKept = 256;  // bytes; longer names are not kept
constexpr double kMoved = 1e-4;                // metres, or entries of a rotation matrix

// Types of small messages that begin with a header; pictures and clouds are not unpacked for their frames.
constexpr std::array<std::string_view, 16> kHeadedTypes{"sensor_msgs/Imu",
                                                        "sensor_msgs/MagneticField",
                                                        "sensor_msgs/NavSatFix",
                                                        "sensor_msgs/Range",
                                                        "sensor_msgs/CameraInfo",
                                                        "sensor_msgs/Joy",
                                                        "sensor_msgs/BatteryState",
                                                        "sensor_msgs/Temperature",
                                                        "geometry_msgs/PoseStamped",
                                                        "geometry_msgs/PoseWithCovarianceStamped",
                                                        "geometry_msgs/PointStamped",
                                                        "geometry_msgs/TwistStamped",
                                                        "geometry_msgs/Vector3Stamped",
                                                        "geometry_msgs/TwistWithCovarianceStamped",
                                                        "geometry_msgs/TransformStamped",
                                                        "geometry_msgs/WrenchStamped"};

bool is_headed(const RecordingChannel& channel) {
  if (channel.encoding == MessageEncoding::kOther) return false;
  return std::find(kHeadedTypes.begin(), kHeadedTypes.end(), short_type(channel.type)) != kHeadedTypes.end();
}

TopicUse topic_use(MessageKind kind) {
  switch (kind) {
    case MessageKind::kScan:
    case MessageKind::kEchoScan:
      return TopicUse::kScans;
    case MessageKind::kOdometry:
      return TopicUse::kOdometry;
    case MessageKind::kTransforms:
      return TopicUse::kFrames;
    case MessageKind::kJoints:
    case MessageKind::kNumber:
      return TopicUse::kCrank;
    case MessageKind::kOther:
      break;
  }
  return TopicUse::kNone;
}

bool has_moved(const Transform3& from, const Transform3& to) {
  const auto differs = [](double a, double b) { return std::fabs(a - b) > kMoved; };
  return !std::equal(from.rotation.begin(), from.rotation.end(), to.rotation.begin(), std::not_fn(differs)) ||
         !std::equal(from.shift_m.begin(), from.shift_m.end(), to.shift_m.begin(), std::not_fn(differs));
}

/// Yaw, pitch and roll of Rz(yaw) Ry(pitch) Rx(roll), which is how ROS states them.
void set_transform(FrameLink& link, const Transform3& T) {
  const std::array<double, 9>& r = T.rotation;
  link.x_m = T.shift_m[0];
  link.y_m = T.shift_m[1];
  link.z_m = T.shift_m[2];
  link.yaw_rad = atan2(r[3], r[0]);
  link.pitch_rad = atan2(-r[6], std::sqrt(r[7] * r[7] + r[8] * r[8]));
  link.roll_rad = atan2(r[7], r[8]);
}

}  // namespace

void RecordingSurvey::add_channel(const RecordingChannel& channel) {
  if (topics_.contains(channel.topic)) return;
  std::size_t& kept = kept_.at(static_cast<std::size_t>(topic_use(message_kind(channel))));
  if (kept == kMostSurveyed) {
    ++left_out_;
    return;
  }
  ++kept;
  TopicContents contents{.name = channel.topic,
                         .type = short_type(channel.type),
                         .encoding = channel.encoding_name,
                         .is_readable = channel.encoding != MessageEncoding::kOther};
  topics_.emplace(channel.topic, Topic{.contents = std::move(contents), .delays_s = {}});
}

bool RecordingSurvey::wants(const TopicChannel& channel) {
  return channel.kind != MessageKind::kOther || is_headed(channel.definition);
}

void RecordingSurvey::add(const TopicChannel& channel, const MessageBytes& message, double received_s) {
  const auto found = topics_.find(channel.definition.topic);
  if (found == topics_.end()) return;
  Topic& topic = found->second;
  TopicContents& contents = topic.contents;
  contents.can_be = topic_use(channel.kind);
  if (contents.messages++ == 0) contents.first_s = received_s;
  contents.last_s = received_s;
  if (message.bytes.empty() || !wants(channel)) return;
  try {
    look_into(topic, channel, message, received_s);
  } catch (const RecordingFault&) {  // the reader reports it if the message counts
  }
}

void RecordingSurvey::look_into(Topic& topic, const TopicChannel& channel, const MessageBytes& message,
                                double received_s) {
  if (channel.kind == MessageKind::kTransforms) return add_transforms(topic, message, received_s);
  if (channel.kind == MessageKind::kNumber) {
    return add_number(topic.contents, read_number(message, channel.definition.type).value);
  }
  MessageCursor cursor(message.bytes, message.encoding);
  const double stamp_s = cursor.header_time();
  add_header(topic, stamp_s, cursor.frame(), received_s);
  if (channel.kind != MessageKind::kJoints) return;
  const std::size_t names = cursor.count(sizeof(std::uint32_t));
  std::vector<std::string>& joints = topic.contents.joints;
  for (std::size_t k = 0; k < names; ++k) {
    const std::string name(cursor.text());
    const bool is_new = joints.size() < kMostJoints && name.size() <= kLongestNameKept &&
                        std::find(joints.begin(), joints.end(), name) == joints.end();
    if (is_new) joints.push_back(name);
  }
  add_number(topic.contents, read_joint(message, "").value);
}

void RecordingSurvey::add_header(Topic& topic, double stamp_s, const std::string& frame, double received_s) {
  if (stamp_s != 0.0) topic.delays_s.add(received_s - stamp_s);
  std::vector<std::string>& frames = topic.contents.frames;
  if (frame.empty() || frame.size() > kLongestNameKept || frames.size() == kMostFramesOfTopic) return;
  if (std::find(frames.begin(), frames.end(), frame) == frames.end()) frames.push_back(frame);
}

void RecordingSurvey::add_number(TopicContents& topic, double value) {
  if (!std::isfinite(value)) return;
  TopicNumbers& numbers = topic.numbers ? *topic.numbers : topic.numbers.emplace(TopicNumbers{value, value});
  numbers.least = std::min(numbers.least, value);
  numbers.most = std::max(numbers.most, value);
}

void RecordingSurvey::add_transforms(Topic& topic, const MessageBytes& message, double received_s) {
  const bool is_static = topic.contents.name.ends_with(kStaticTransforms);
  for (const TransformMessage& transform : read_transforms(message)) {
    // A static transform is stamped when it was set, and received when the recording began.
    if (!is_static && transform.stamp_s != 0.0) topic.delays_s.add(received_s - transform.stamp_s);
    if (std::max(transform.parent.size(), transform.child.size()) > kLongestNameKept) continue;
    auto known = links_.find(transform.child);
    if (known == links_.end()) {
      if (links_.size() == FrameTree::kMostFrames) continue;
      FrameLink link{
          .parent = transform.parent, .child = transform.child, .is_static = is_static, .first_s = received_s};
      known = links_.emplace(transform.child, Link{std::move(link), transform.T_parent_child}).first;
    }
    Link& edge = known->second;
    edge.link.moves = edge.link.moves || has_moved(edge.T_first, transform.T_parent_child);
    edge.link.is_static = edge.link.is_static && is_static;
    edge.link.parent = transform.parent;
    edge.link.last_s = received_s;
    ++edge.link.messages;
    set_transform(edge.link, transform.T_parent_child);
  }
}

LogContents RecordingSurvey::contents() const {
  constexpr double kLow = 0.05;
  constexpr double kHigh = 0.95;
  LogContents contents;
  contents.is_recording = true;
  contents.topics_left_out = left_out_;
  contents.topics.reserve(topics_.size());
  for (const auto& [name, topic] : topics_) {
    contents.topics.push_back(topic.contents);
    if (topic.delays_s.seen() == 0) continue;
    contents.topics.back().delay = TopicDelay{.messages = topic.delays_s.seen(),
                                              .median_s = topic.delays_s.quantile(0.5),
                                              .low_s = topic.delays_s.quantile(kLow),
                                              .high_s = topic.delays_s.quantile(kHigh)};
  }
  contents.frames.reserve(links_.size());
  for (const auto& [child, link] : links_) contents.frames.push_back(link.link);
  return contents;
}

}  // namespace gdtslam

#include "messages.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "engine/io/message_text.hpp"
#include "gdtslam/core/angle.hpp"
#include "message_cursor.hpp"

namespace gdtslam {
namespace {

// Lasers are made in degrees: finds the angle in degrees with the fewest decimals, up to four, that rounds to this one
// in radians.
double unrounded_angle(float rounded_rad) {
  const double deg = deg_from_rad(static_cast<double>(rounded_rad));
  for (double parts = 1.0; parts <= 10000.0; parts *= 10.0) {
    const double whole_rad = rad_from_deg(std::floor(deg * parts + 0.5) / parts);
    if (static_cast<float>(whole_rad) == rounded_rad) return whole_rad;
  }
  return static_cast<double>(rounded_rad);
}

/// Types by name, and by the MD5 sum of their definition in ROS 1.
struct KnownType {
  std::string_view name;
  std::string_view md5;
  MessageKind kind;
};
constexpr std::array<KnownType, 6> kKnownTypes = {{
    {"sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369", MessageKind::kScan},
    {"sensor_msgs/MultiEchoLaserScan", "6fefb0c6da89d7c8abe4b339f5c2f8fb", MessageKind::kEchoScan},
    {"nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7", MessageKind::kOdometry},
    {"tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec", MessageKind::kTransforms},
    {"tf/tfMessage", "94810edda583a504dfda3829e70d7eec", MessageKind::kTransforms},
    {"sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd", MessageKind::kJoints},
}};
constexpr std::string_view kNumberPackage = "std_msgs/";
constexpr std::array<std::string_view, 10> kNumberTypes{"Int8",   "Int16",  "Int32",  "Int64",   "UInt8",
                                                        "UInt16", "UInt32", "UInt64", "Float32", "Float64"};

bool is_number_type(std::string_view type) {
  if (!type.starts_with(kNumberPackage)) return false;
  type.remove_prefix(kNumberPackage.size());
  for (const std::string_view known : kNumberTypes) {
    if (type == known) return true;
  }
  return false;
}

// Translation, then the quaternion x, y, z, w.
Transform3 read_transform(MessageCursor& cursor) {
  Transform3 T;
  for (double& value : T.shift_m) value = cursor.real();
  const double x = cursor.real();
  const double y = cursor.real();
  const double z = cursor.real();
  const double w = cursor.real();
  const double sq_norm = x * x + y * y + z * z + w * w;
  const double s = sq_norm > 0.0 ? 2.0 / sq_norm : 0.0;  // 0: some writers omit the quaternion without a rotation
  T.rotation = {1.0 - s * (y * y + z * z), s * (x * y - z * w),       s * (x * z + y * w),
                s * (x * y + z * w),       1.0 - s * (x * x + z * z), s * (y * z - x * w),
                s * (x * z - y * w),       s * (y * z + x * w),       1.0 - s * (x * x + y * y)};
  return T;
}

TransformMessage stamped_transform(MessageCursor& cursor) {
  TransformMessage transform;
  transform.stamp_s = cursor.header_time();
  transform.parent = cursor.frame();
  transform.child = cursor.frame();
  transform.T_parent_child = read_transform(cursor);
  if (!transform.T_parent_child.is_finite()) throw RecordingFault("has a pose that is not finite");
  return transform;
}

/// Reads everything before the ranges, which is the same for one and several echoes.
ScanMessage scan_without_ranges(MessageCursor& cursor) {
  ScanMessage scan;
  scan.stamp_s = cursor.header_time();
  scan.frame = cursor.frame();
  scan.first_bearing_rad = unrounded_angle(cursor.single());
  (void)cursor.single();  // the last bearing; it follows from the step
  scan.bearing_step_rad = unrounded_angle(cursor.single());
  scan.beam_period_s = static_cast<double>(cursor.single());
  (void)cursor.single();  // between scans, seconds
  scan.min_range_m = static_cast<double>(cursor.single());
  scan.max_range_m = static_cast<double>(cursor.single());
  return scan;
}

/// Drivers divide by the number of steps, which makes bearings not finite for a scan of one beam or none.
void check_bearings(ScanMessage& scan) {
  const std::size_t beams = scan.ranges_m.size();
  if (beams == 0 && !std::isfinite(scan.first_bearing_rad)) scan.first_bearing_rad = 0.0;
  if (beams <= 1 && !std::isfinite(scan.bearing_step_rad)) scan.bearing_step_rad = 0.0;
  const bool are_finite = std::isfinite(scan.first_bearing_rad) && std::isfinite(scan.bearing_step_rad);
  if (!are_finite || (beams > 1 && scan.bearing_step_rad == 0.0)) {
    throw RecordingFault("has a scan whose bearings are not finite, or all the same");
  }
}

}  // namespace

std::string short_type(std::string_view type) {
  constexpr std::string_view kMiddle = "/msg/";
  std::string text(type);
  if (const std::size_t at = text.find(kMiddle); at != std::string::npos) text.replace(at, kMiddle.size(), "/");
  return text;
}

MessageKind message_kind(const RecordingChannel& channel) {
  if (channel.encoding == MessageEncoding::kOther) return MessageKind::kOther;
  const std::string type = short_type(channel.type);
  for (const KnownType& known : kKnownTypes) {
    if (type == known.name || channel.md5 == known.md5) return known.kind;
  }
  return is_number_type(type) ? MessageKind::kNumber : MessageKind::kOther;
}

ScanMessage read_scan(const MessageBytes& message) {
  MessageCursor cursor(message.bytes, message.encoding);
  ScanMessage scan = scan_without_ranges(cursor);
  cursor.singles(scan.ranges_m);
  check_bearings(scan);
  return scan;
}

ScanMessage read_echo_scan(const MessageBytes& message) {
  MessageCursor cursor(message.bytes, message.encoding);
  ScanMessage scan = scan_without_ranges(cursor);
  const std::size_t beams = cursor.count(sizeof(std::uint32_t));
  scan.ranges_m.reserve(beams);
  for (std::size_t k = 0; k < beams; ++k) {
    const std::size_t echoes = cursor.count(sizeof(float));
    scan.ranges_m.push_back(echoes > 0 ? cursor.single() : std::numeric_limits<float>::infinity());
    for (std::size_t further = 1; further < echoes; ++further) (void)cursor.single();
  }
  check_bearings(scan);
  return scan;
}

TransformMessage read_odometry(const MessageBytes& message) {
  MessageCursor cursor(message.bytes, message.encoding);
  return stamped_transform(cursor);  // the covariance and speeds after it are not used
}

std::vector<TransformMessage> read_transforms(const MessageBytes& message) {
  constexpr std::size_t kLeastBytes = 2 * 4 + 2 * 4 + 7 * 8;  // a time, two names, seven numbers
  MessageCursor cursor(message.bytes, message.encoding);
  const std::size_t count = cursor.count(kLeastBytes);
  std::vector<TransformMessage> transforms;
  transforms.reserve(count);
  for (std::size_t k = 0; k < count; ++k) transforms.push_back(stamped_transform(cursor));
  return transforms;
}

NumberMessage read_joint(const MessageBytes& message, std::string_view joint) {
  MessageCursor cursor(message.bytes, message.encoding);
  NumberMessage number;
  number.stamp_s = cursor.header_time();
  (void)cursor.text();  // frame
  const std::size_t names = cursor.count(sizeof(std::uint32_t));
  std::size_t wanted = names;
  for (std::size_t k = 0; k < names; ++k) {
    const std::string_view name = cursor.text();
    if (wanted == names && (joint.empty() || name == joint)) wanted = k;
  }
  if (wanted == names) {
    throw RecordingFault(joint.empty() ? "has joints without names"
                                       : fmt::format("has joints of which none is called {}", in_quotes(joint)));
  }
  const std::size_t positions = cursor.count(sizeof(double));
  if (wanted >= positions) throw RecordingFault("has joints without a position");
  for (std::size_t k = 0; k <= wanted; ++k) number.value = cursor.real();
  return number;
}

NumberMessage read_number(const MessageBytes& message, std::string_view type) {
  MessageCursor cursor(message.bytes, message.encoding);
  std::string kind = short_type(type);
  kind.erase(0, kNumberPackage.size());
  if (kind == "Float32") return {.value = static_cast<double>(cursor.single())};
  if (kind == "Float64") return {.value = cursor.real()};
  const auto whole = [](std::int64_t value) {
    return NumberMessage{.value = static_cast<double>(value), .whole = value};
  };
  if (kind == "Int8") return whole(cursor.whole<std::int8_t>());
  if (kind == "Int16") return whole(cursor.whole<std::int16_t>());
  if (kind == "Int32") return whole(cursor.whole<std::int32_t>());
  if (kind == "UInt8") return whole(cursor.whole<std::uint8_t>());
  if (kind == "UInt16") return whole(cursor.whole<std::uint16_t>());
  if (kind == "UInt32") return whole(cursor.whole<std::uint32_t>());
  return whole(cursor.whole<std::int64_t>());  // UInt64 continues as a counter that wraps
}

}  // namespace gdtslam

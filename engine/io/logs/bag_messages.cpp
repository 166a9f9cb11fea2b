#include "bag_messages.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstddef>

#include "bag_records.hpp"
#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

/// Little endian values one after the other.
class RosCursor {
 public:
  explicit RosCursor(std::string_view bytes) : bytes_(bytes) {}

  template <class Whole>
  Whole whole() {
    const std::string_view raw = take(sizeof(Whole));
    Whole value = 0;
    for (std::size_t k = 0; k < sizeof(Whole); ++k) {
      value |= static_cast<Whole>(static_cast<Whole>(static_cast<unsigned char>(raw[k])) << (8U * k));
    }
    return value;
  }
  float single() { return std::bit_cast<float>(whole<std::uint32_t>()); }
  double real() { return std::bit_cast<double>(whole<std::uint64_t>()); }
  double time() {
    const double seconds = whole<std::uint32_t>();
    return seconds + 1.0e-9 * whole<std::uint32_t>();
  }
  std::string frame() {
    std::string_view name = take(whole<std::uint32_t>());
    if (name.starts_with('/')) name.remove_prefix(1);
    return std::string(name);
  }
  Transform3 transform() {
    Transform3 T;
    for (double& value : T.shift_m) value = real();
    const double x = real();
    const double y = real();
    const double z = real();
    const double w = real();
    const double sq_norm = x * x + y * y + z * z + w * w;
    const double s = sq_norm > 0.0 ? 2.0 / sq_norm : 0.0;  // 0: some leave it out where nothing is turned
    T.rotation = {1.0 - s * (y * y + z * z), s * (x * y - z * w),       s * (x * z + y * w),
                  s * (x * y + z * w),       1.0 - s * (x * x + z * z), s * (y * z - x * w),
                  s * (x * z - y * w),       s * (y * z + x * w),       1.0 - s * (x * x + y * y)};
    return T;
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view take(std::size_t count) {
    if (count > bytes_.size()) throw BagFault("has a message that ends too early");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::string_view bytes_;
};

BagTransform stamped_transform(RosCursor& cursor) {
  BagTransform transform;
  (void)cursor.whole<std::uint32_t>();  // sequence number
  transform.stamp_s = cursor.time();
  transform.parent = cursor.frame();
  transform.child = cursor.frame();
  transform.T_parent_child = cursor.transform();
  if (!transform.T_parent_child.is_finite()) throw BagFault("has a pose that is not finite");
  return transform;
}

}  // namespace

BagMessage bag_message_of(std::string_view type, std::string_view md5) {
  if (type == "sensor_msgs/LaserScan" || md5 == "90c7ef2dc6895d81024acba2ac42f369") return BagMessage::kScan;
  if (type == "nav_msgs/Odometry" || md5 == "cd5e73d190d741a2f92e81eda573aca7") return BagMessage::kOdometry;
  const bool is_tf = type == "tf2_msgs/TFMessage" || type == "tf/tfMessage";
  return is_tf || md5 == "94810edda583a504dfda3829e70d7eec" ? BagMessage::kTransforms : BagMessage::kOther;
}

bool Transform3::is_finite() const {
  for (const double value : rotation) {
    if (!std::isfinite(value)) return false;
  }
  for (const double value : shift_m) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

Transform3 operator*(const Transform3& a, const Transform3& b) {
  Transform3 product;
  for (std::size_t i = 0; i < 3; ++i) {
    const double* const row = a.rotation.data() + 3 * i;
    for (std::size_t j = 0; j < 3; ++j) {
      product.rotation[3 * i + j] = row[0] * b.rotation[j] + row[1] * b.rotation[3 + j] + row[2] * b.rotation[6 + j];
    }
    product.shift_m[i] = row[0] * b.shift_m[0] + row[1] * b.shift_m[1] + row[2] * b.shift_m[2] + a.shift_m[i];
  }
  return product;
}

Pose2 seen_from_above(const Transform3& transform) {
  return {transform.shift_m[0], transform.shift_m[1], atan2(transform.rotation[3], transform.rotation[0])};
}

BagScan bag_scan(std::string_view bytes) {
  RosCursor cursor(bytes);
  BagScan scan;
  (void)cursor.whole<std::uint32_t>();  // sequence number
  scan.stamp_s = cursor.time();
  scan.frame = cursor.frame();
  scan.first_bearing_rad = static_cast<double>(cursor.single());
  (void)cursor.single();  // the last bearing, which follows from the step
  scan.bearing_step_rad = static_cast<double>(cursor.single());
  (void)cursor.single();  // between beams, and
  (void)cursor.single();  // between scans, seconds
  scan.min_range_m = static_cast<double>(cursor.single());
  scan.max_range_m = static_cast<double>(cursor.single());
  const std::size_t beams = cursor.whole<std::uint32_t>();
  if (beams > cursor.left() / sizeof(float)) throw BagFault("has a scan with fewer ranges than it states");
  scan.ranges_m.reserve(beams);
  for (std::size_t k = 0; k < beams; ++k) scan.ranges_m.push_back(cursor.single());
  const bool has_bearings = std::isfinite(scan.first_bearing_rad) && std::isfinite(scan.bearing_step_rad);
  if (!has_bearings || (beams > 1 && scan.bearing_step_rad == 0.0)) {
    throw BagFault("has a scan whose bearings are not finite, or all the same");
  }
  return scan;
}

BagTransform bag_odometry(std::string_view bytes) {
  RosCursor cursor(bytes);
  return stamped_transform(cursor);  // the covariance and speeds behind it are not used
}

std::vector<BagTransform> bag_transforms(std::string_view bytes) {
  RosCursor cursor(bytes);
  const std::size_t count = cursor.whole<std::uint32_t>();
  std::vector<BagTransform> transforms;
  for (std::size_t k = 0; k < count; ++k) transforms.push_back(stamped_transform(cursor));
  return transforms;
}

}  // namespace gdtslam

#include "ros_messages.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/core/elementary.hpp"
#include "engine/io/little_endian.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/nodding.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kCovarianceNumbers = 36;

/// A sequence of little endian values. Each starts at a multiple of its size, counted from the end of the four bytes of
/// the encoding.
class WrittenMessage {
 public:
  template <class Whole>
  void whole(Whole value) {
    while ((bytes_.size() - kEncapsulation) % sizeof(Whole) != 0) bytes_ += '\0';
    append_little_endian(bytes_, value);
  }
  void count(std::size_t value) { whole(static_cast<std::uint32_t>(value)); }
  void single(float value) { whole(std::bit_cast<std::uint32_t>(value)); }
  void real(double value) { whole(std::bit_cast<std::uint64_t>(value)); }
  void text(std::string_view value) {
    count(value.size() + 1);
    bytes_ += value;
    bytes_ += '\0';
  }
  void time(double stamp_s) {
    const auto ns = static_cast<std::uint64_t>(ros_time_ns(stamp_s));
    whole(static_cast<std::uint32_t>(ns / 1'000'000'000U));
    whole(static_cast<std::uint32_t>(ns % 1'000'000'000U));
  }
  void header(const RosStamp& stamp) {
    time(stamp.stamp_s);
    text(stamp.frame);
  }
  void pose(const Pose2& pose) {
    for (const double value : {pose.x_m, pose.y_m, 0.0, 0.0, 0.0}) real(value);
    const SinCos<double> half = sin_cos(0.5 * pose.theta_rad);
    real(half.sin);
    real(half.cos);
  }
  void cells(std::span<const std::int8_t> values) {
    count(values.size());
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size());
  }
  std::string take() { return std::move(bytes_); }

 private:
  static constexpr std::size_t kEncapsulation = 4;
  std::string bytes_ = std::string("\0\1\0\0", kEncapsulation);
};

}  // namespace

std::int64_t ros_time_ns(double stamp_s) {
  const double seconds = std::floor(stamp_s);
  return static_cast<std::int64_t>(seconds) * 1'000'000'000 + std::llround((stamp_s - seconds) * 1e9);
}

double ros_scan_stamp_s(const LaserScan& scan) {
  const double steps = scan.ranges_m.empty() ? 0.0 : static_cast<double>(scan.ranges_m.size() - 1);
  return scan.stamp_s + (scan.first_beam_after_s + std::min(0.0, steps * scan.beam_period_s));
}

std::string ros_laser_scan(const LaserScan& scan, std::string_view frame, double scan_time_s) {
  if (scan.beam_period_s < 0.0 && !scan.ranges_m.empty()) {
    LaserScan ordered = scan;
    order_beams_by_time(ordered);
    return ros_laser_scan(ordered, frame, scan_time_s);
  }
  WrittenMessage bytes;
  const std::size_t beams = scan.ranges_m.size();
  const double steps = beams == 0 ? 0.0 : static_cast<double>(beams - 1);
  bytes.header({ros_scan_stamp_s(scan), frame});
  const double limit_m = scan.max_range_m > 0.0 ? scan.max_range_m : std::numeric_limits<double>::infinity();
  for (const double value : {scan.first_bearing_rad, scan.first_bearing_rad + steps * scan.bearing_step_rad,
                             scan.bearing_step_rad, scan.beam_period_s, scan_time_s, 0.0, limit_m}) {
    bytes.single(static_cast<float>(value));
  }
  bytes.count(beams);
  for (const float range_m : scan.ranges_m) bytes.single(range_m);
  bytes.count(0);  // intensities
  return bytes.take();
}

std::string ros_odometry(const RosTransform& pose, const RosSpeed& speed) {
  WrittenMessage bytes;
  bytes.header(pose.parent);
  bytes.text(pose.child);
  bytes.pose(pose.T_parent_child);
  for (std::size_t k = 0; k < kCovarianceNumbers; ++k) bytes.real(0.0);  // 0: not known
  for (const double value : {speed.forward_m_per_s, 0.0, 0.0, 0.0, 0.0, speed.turn_rad_per_s}) bytes.real(value);
  for (std::size_t k = 0; k < kCovarianceNumbers; ++k) bytes.real(0.0);
  return bytes.take();
}

std::string ros_transforms(std::span<const RosTransform> transforms) {
  WrittenMessage bytes;
  bytes.count(transforms.size());
  for (const RosTransform& one : transforms) {
    bytes.header(one.parent);
    bytes.text(one.child);
    bytes.pose(one.T_parent_child);
  }
  return bytes.take();
}

std::string ros_int32(std::int32_t value) {
  WrittenMessage bytes;
  bytes.whole(static_cast<std::uint32_t>(value));
  return bytes.take();
}

std::string ros_joint_state(const RosStamp& stamp, std::string_view joint, double position) {
  WrittenMessage bytes;
  bytes.header(stamp);
  bytes.count(1);
  bytes.text(joint);
  bytes.count(1);
  bytes.real(position);
  bytes.count(0);  // speeds, and
  bytes.count(0);  // efforts
  return bytes.take();
}

std::string ros_pose(const RosStamp& stamp, const Pose2& pose) {
  WrittenMessage bytes;
  bytes.header(stamp);
  bytes.pose(pose);
  return bytes.take();
}

std::string ros_occupancy_grid(const RosStamp& stamp, const RosGrid& grid) {
  WrittenMessage bytes;
  bytes.header(stamp);
  bytes.time(stamp.stamp_s);
  bytes.single(static_cast<float>(grid.resolution_m));
  bytes.whole(grid.width);
  bytes.whole(grid.height);
  bytes.pose(grid.T_map_origin);
  bytes.cells(grid.cells);
  return bytes.take();
}

}  // namespace gdtslam

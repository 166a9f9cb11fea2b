#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "engine/io/logs/steady_mount.hpp"
#include "log_formats.hpp"
#include "mcap_writer.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kOdomFrame = "odom";
constexpr std::string_view kBaseFrame = "base_link";

std::string numbered(std::string_view name, std::size_t laser) {
  return laser == 0 ? std::string(name) : fmt::format("{}_{}", name, laser + 1);
}

class RosLog final : public LogWriter {
 public:
  RosLog(AtomicFile& file, ChunkPacking packing) : container_(file, packing) {}
  bool write(const LogRecord& record) override {
    if (const auto* scan = std::get_if<ScanRecord>(&record)) {
      if (!is_stamp_possible(scan->scan.stamp_s) || !is_stamp_possible(ros_scan_stamp_s(scan->scan))) {
        return false;
      }
      write_scan(*scan);
    } else if (const auto* odometry = std::get_if<Odometry>(&record)) {
      if (!is_stamp_possible(odometry->stamp_s)) return false;
      write_odometry(*odometry);
    } else if (const auto* encoder = std::get_if<Encoder>(&record)) {
      return is_stamp_possible(encoder->stamp_s) && write_encoder(*encoder);
    } else if (const auto* tilt = std::get_if<Tilt>(&record)) {
      if (!is_stamp_possible(tilt->stamp_s)) return false;
      write_tilt(*tilt);
    } else if (const auto* parameter = std::get_if<Parameter>(&record)) {
      leave_out("parameter", parameter->name);
      return false;
    }
    return true;
  }
  void finish() override { container_.finish(); }
  [[nodiscard]] std::uint64_t bytes() const override { return container_.bytes(); }

 private:
  bool is_stamp_possible(double stamp_s) {
    if (stamp_s >= 0.0 && stamp_s < kRosStampLimit_s) return true;
    leave_out("stamp that ROS does not know", fmt::format("{} s is not between 1970 and 2038", stamp_s));
    return false;
  }

  /// The channel of the topic, made if it is new.
  std::uint32_t channel(const std::string& topic, RosType type, bool is_latched = false) {
    const auto known = channels_.find(topic);
    if (known != channels_.end()) return known->second;
    return channels_.emplace(topic, container_.add_channel(topic, type, is_latched)).first->second;
  }

  /// The time at which a robot would have received a message with this stamp: never before earlier messages.
  std::int64_t received_ns(double stamp_s) {
    newest_ns_ = std::max(newest_ns_, ros_time_ns(stamp_s));
    return newest_ns_;
  }

  void write_mount(const ScanRecord& record, const std::string& frame) {
    const Pose2& mount = record.scan.T_base_laser;
    const auto told = mounts_.find(record.laser);
    if (told != mounts_.end() && is_same_mount(told->second, mount)) return;
    if (told != mounts_.end()) {
      leave_out("change of a mount",
                fmt::format("at {:.6f} s: most readers keep the first /tf_static", record.scan.stamp_s));
    }
    mounts_[record.laser] = mount;
    const RosTransform T{{record.scan.stamp_s, kBaseFrame}, frame, mount};
    container_.add(channel("/tf_static", RosType::kTransforms, true), received_ns(record.scan.stamp_s),
                   ros_transforms({&T, 1}));
  }

  void write_odometry(const Odometry& odometry) {
    if (last_ && last_->stamp_s == odometry.stamp_s && last_->T_odom_base == odometry.T_odom_base) return;
    if (const double elapsed_s = last_ ? odometry.stamp_s - last_->stamp_s : 0.0; elapsed_s > 0.0) {
      const Eigen::Vector3d moved = log_se2(between(last_->T_odom_base, odometry.T_odom_base));
      speed_ = {moved.x() / elapsed_s, moved.z() / elapsed_s};
    }
    last_ = odometry;
    const RosTransform pose{{odometry.stamp_s, kOdomFrame}, kBaseFrame, odometry.T_odom_base};
    const std::int64_t now_ns = received_ns(odometry.stamp_s);
    container_.add(channel("/odom", RosType::kOdometry), now_ns, ros_odometry(pose, speed_));
    container_.add(channel("/tf", RosType::kTransforms), now_ns, ros_transforms({&pose, 1}));
  }

  void write_scan(const ScanRecord& record) {
    const LaserScan& scan = record.scan;
    const std::string frame = numbered("laser", record.laser);
    if (record.T_odom_base) write_odometry({scan.stamp_s, *record.T_odom_base});
    write_mount(record, frame);
    const auto before = scan_stamps_s_.find(record.laser);
    const double scan_time_s = before == scan_stamps_s_.end() ? 0.0 : std::max(0.0, scan.stamp_s - before->second);
    scan_stamps_s_[record.laser] = scan.stamp_s;
    container_.add(channel(numbered("/scan", record.laser), RosType::kLaserScan), received_ns(scan.stamp_s),
                   ros_laser_scan(scan, frame, scan_time_s));
  }

  // Its message has no stamp, so its time of receipt counts.
  bool write_encoder(const Encoder& encoder) {
    using Limits = std::numeric_limits<std::int32_t>;
    if (encoder.ticks < Limits::min() || encoder.ticks > Limits::max()) {
      leave_out("crank beyond 32 bits", std::to_string(encoder.ticks));
      return false;
    }
    container_.add(channel("/crank", RosType::kInt32), ros_time_ns(encoder.stamp_s),
                   ros_int32(static_cast<std::int32_t>(encoder.ticks)));
    return true;
  }

  void write_tilt(const Tilt& tilt) {
    container_.add(channel("/tilt", RosType::kJointState), received_ns(tilt.stamp_s),
                   ros_joint_state({tilt.stamp_s, kBaseFrame}, "tilt", tilt.elevation_rad));
  }

  McapWriter container_;
  std::map<std::string, std::uint32_t> channels_;
  std::map<std::size_t, Pose2> mounts_;  ///< written last, by laser
  std::map<std::size_t, double> scan_stamps_s_;
  std::optional<Odometry> last_;
  RosSpeed speed_;
  std::int64_t newest_ns_ = 0;
};

}  // namespace

std::unique_ptr<LogWriter> make_ros_log(AtomicFile& file, ChunkPacking packing) {
  return std::make_unique<RosLog>(file, packing);
}

}  // namespace gdtslam

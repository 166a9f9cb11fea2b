// The records of a log as ROS messages: /scan (and /scan_2, ... for further lasers) sensor_msgs/LaserScan, /odom
// nav_msgs/Odometry, /tf from odom to base_link, /tf_static from base_link to the laser, /crank std_msgs/Int32, /tilt
// sensor_msgs/JointState. Odometry of a scan is a message of its stamp just before it. One object belongs to one
// thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "log_writer.hpp"
#include "mcap_writer.hpp"

namespace gdtslam {

class RosLog final : public LogWriter {
 public:
  /// `file` must outlive this.
  RosLog(AtomicFile& file, ChunkPacking packing) : container_(file, packing) {}
  bool write(const LogRecord& record) override;
  void finish() override { container_.finish(); }
  [[nodiscard]] std::uint64_t bytes() const override { return container_.bytes(); }

 private:
  void write_scan(const ScanRecord& record);
  void write_odometry(const Odometry& odometry);
  void write_mount(const ScanRecord& record, const std::string& frame);
  bool write_encoder(const Encoder& encoder);
  void write_tilt(const Tilt& tilt);
  bool is_stamp_possible(double stamp_s);
  /// The channel of the topic, made where it is new.
  std::uint32_t channel(const std::string& topic, RosType type, bool is_latched = false);
  /// The time at which a robot would have got what is stamped so: never before what it got already.
  std::int64_t received_ns(double stamp_s);

  McapWriter container_;
  std::map<std::string, std::uint32_t> channels_;
  std::map<std::size_t, Pose2> mounts_;  ///< told last, by laser
  std::map<std::size_t, double> scan_stamps_s_;
  std::optional<Odometry> last_;
  RosSpeed speed_;
  std::int64_t newest_ns_ = 0;
};

}  // namespace gdtslam

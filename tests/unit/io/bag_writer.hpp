// Bags as the format's page describes them (wiki.ros.org/Bags/Format/2.0), written for tests: records of fields and
// data, messages little endian.
#pragma once

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace gdtslam::test {

template <class Value>
std::string raw(Value value) {
  std::string bytes(sizeof(Value), '\0');
  std::memcpy(bytes.data(), &value, sizeof(Value));  // the hosts of these tests are little endian, as ROS is
  return bytes;
}
inline std::string sized(const std::string& text) { return raw(static_cast<std::uint32_t>(text.size())) + text; }

using BagFieldList = std::vector<std::pair<std::string, std::string>>;
inline std::string bag_fields(const BagFieldList& fields) {
  std::string text;
  for (const auto& [name, value] : fields) text += sized(name + "=" + value);
  return text;
}
inline std::string bag_record(const BagFieldList& fields, const std::string& data) {
  return sized(bag_fields(fields)) + sized(data);
}
inline std::string op(char code) { return std::string(1, code); }
inline std::string ros_time(double stamp_s) {
  const double whole = std::floor(stamp_s);
  return raw(static_cast<std::uint32_t>(whole)) + raw(static_cast<std::uint32_t>(std::lround((stamp_s - whole) * 1e9)));
}

inline std::string bag_connection(std::uint32_t number, const std::string& topic, const std::string& type) {
  return bag_record({{"op", op(7)}, {"conn", raw(number)}, {"topic", topic}},
                    bag_fields({{"topic", topic}, {"type", type}, {"md5sum", "*"}, {"message_definition", ""}}));
}
inline std::string bag_message(std::uint32_t number, double received_s, const std::string& data) {
  return bag_record({{"op", op(2)}, {"conn", raw(number)}, {"time", ros_time(received_s)}}, data);
}
inline std::string bag_chunk(const std::string& data, const std::string& compression) {
  std::string packed = data;
  if (compression == "bz2") {
    unsigned size = static_cast<unsigned>(data.size() + data.size() / 100 + 600);
    packed.resize(size);
    std::string copy = data;
    EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &size, copy.data(), static_cast<unsigned>(copy.size()), 9, 0, 0),
              BZ_OK);
    packed.resize(size);
  } else if (compression == "lz4") {
    packed.resize(LZ4F_compressFrameBound(data.size(), nullptr));
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), data.data(), data.size(), nullptr));
  }
  return bag_record(
      {{"op", op(5)}, {"compression", compression}, {"size", raw(static_cast<std::uint32_t>(data.size()))}}, packed);
}
/// `stated` in place of the right length of its data.
inline std::string bag_index(std::uint32_t number, std::uint32_t count, std::uint32_t stated) {
  const std::string header =
      bag_fields({{"op", op(4)}, {"ver", raw(std::uint32_t{1})}, {"conn", raw(number)}, {"count", raw(count)}});
  return sized(header) + raw(stated) + std::string(std::size_t{12} * count, '\7');
}
inline std::string bag_file(const std::string& records) {
  const BagFieldList fields{{"op", op(3)},
                            {"index_pos", raw(std::uint64_t{0})},
                            {"conn_count", raw(std::uint32_t{0})},
                            {"chunk_count", raw(std::uint32_t{0})}};
  return "#ROSBAG V2.0\n" + bag_record(fields, std::string(200, ' ')) + records;
}

inline std::string ros_header(double stamp_s, const std::string& frame) {
  return raw(std::uint32_t{7}) + ros_time(stamp_s) + sized(frame);
}
struct RosScan {
  double stamp_s = 0.0;
  std::string frame = "laser";
  float first_rad = -1.0F;
  float step_rad = 0.5F;
  float beam_period_s = 0.0F;
  float least_m = 0.1F;
  float most_m = 30.0F;
  std::vector<float> ranges_m = {1.0F, 2.0F, 3.0F};
};
inline std::string ros_scan(const RosScan& scan) {
  std::string bytes = ros_header(scan.stamp_s, scan.frame) + raw(scan.first_rad) + raw(0.0F) + raw(scan.step_rad) +
                      raw(scan.beam_period_s) + raw(0.1F) + raw(scan.least_m) + raw(scan.most_m);
  bytes += raw(static_cast<std::uint32_t>(scan.ranges_m.size()));
  for (const float range_m : scan.ranges_m) bytes += raw(range_m);
  return bytes + raw(std::uint32_t{0});
}
/// A rotation by an angle about z, or about x.
struct RosPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  bool is_upside_down = false;  ///< then not turned about z
};
inline std::string ros_pose(const RosPose& pose) {
  std::string bytes = raw(pose.x_m) + raw(pose.y_m) + raw(0.25);
  if (pose.is_upside_down) return bytes + raw(1.0) + raw(0.0) + raw(0.0) + raw(0.0);
  return bytes + raw(0.0) + raw(0.0) + raw(std::sin(0.5 * pose.yaw_rad)) + raw(std::cos(0.5 * pose.yaw_rad));
}
inline std::string ros_odometry(double stamp_s, const RosPose& pose) {
  return ros_header(stamp_s, "odom") + sized("base_link") + ros_pose(pose) + std::string(36 * 8 + 6 * 8 + 36 * 8, '\0');
}
inline std::string ros_transform(double stamp_s, const std::string& parent, const std::string& child,
                                 const RosPose& pose) {
  return raw(std::uint32_t{1}) + ros_header(stamp_s, parent) + sized(child) + ros_pose(pose);
}

}  // namespace gdtslam::test

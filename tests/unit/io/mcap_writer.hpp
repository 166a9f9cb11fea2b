// MCAP files and CDR messages as their specifications describe them, written for tests.
#pragma once

#include <gtest/gtest.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "bag_writer.hpp"

namespace gdtslam::test {

inline std::string mcap_record(char kind, const std::string& content) {
  return std::string(1, kind) + raw(static_cast<std::uint64_t>(content.size())) + content;
}
inline std::string mcap_channel(std::uint16_t number, const std::string& topic, const std::string& type,
                                const std::string& encoding) {
  const auto schema = static_cast<std::uint16_t>(number + 1);
  return mcap_record('\3', raw(schema) + sized(type) + sized("") + sized("")) +
         mcap_record('\4', raw(number) + raw(schema) + sized(topic) + sized(encoding) + raw(std::uint32_t{0}));
}
inline std::string mcap_message(std::uint16_t number, double received_s, const std::string& data) {
  const auto time_ns = static_cast<std::uint64_t>(std::llround(received_s * 1e9));
  return mcap_record('\5', raw(number) + raw(std::uint32_t{0}) + raw(time_ns) + raw(time_ns) + data);
}
inline std::uint32_t crc_of(const std::string& data) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(data.data()), static_cast<uInt>(data.size())));
}
inline std::string packed_as(const std::string& compression, const std::string& data) {
  std::string packed = data;
  if (compression == "zstd") {
    packed.resize(ZSTD_compressBound(data.size()));
    packed.resize(ZSTD_compress(packed.data(), packed.size(), data.data(), data.size(), 3));
  } else if (compression == "lz4") {
    packed.resize(LZ4F_compressFrameBound(data.size(), nullptr));
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), data.data(), data.size(), nullptr));
  }
  return packed;
}
/// `stated` in place of the right length and sum of its data.
struct ChunkClaims {
  std::uint64_t bytes = 0;
  std::uint32_t crc = 0;
};
inline std::string mcap_chunk(const std::string& data, const std::string& compression, const ChunkClaims& claims) {
  const std::string packed = packed_as(compression, data);
  return mcap_record('\6', raw(std::uint64_t{0}) + raw(std::uint64_t{0}) + raw(claims.bytes) + raw(claims.crc) +
                               sized(compression) + raw(static_cast<std::uint64_t>(packed.size())) + packed);
}
inline std::string mcap_chunk(const std::string& data, const std::string& compression) {
  return mcap_chunk(data, compression, {.bytes = data.size(), .crc = crc_of(data)});
}
inline constexpr const char* kMcapStart = "\x89MCAP0\r\n";
inline std::string mcap_head() { return kMcapStart + mcap_record('\1', sized("ros2") + sized("")); }
inline std::string mcap_tail() {
  return mcap_record('\17', raw(std::uint32_t{0})) + mcap_record('\2', std::string(20, '\0')) + kMcapStart;
}
inline std::string mcap_file(const std::string& records) { return mcap_head() + records + mcap_tail(); }

/// Values of CDR: little or big endian, each aligned to its own size behind the first four bytes.
class CdrWriter {
 public:
  explicit CdrWriter(bool is_big = false) : is_big_(is_big) {}
  template <class Value>
  CdrWriter& put(Value value) {
    while (bytes_.size() % sizeof(Value) != 0) bytes_ += '\0';
    const std::string text = raw(value);
    bytes_ += is_big_ ? std::string(text.rbegin(), text.rend()) : text;
    return *this;
  }
  CdrWriter& text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size() + 1));
    bytes_ += value + '\0';
    return *this;
  }
  CdrWriter& header(double stamp_s, const std::string& frame) {
    const double whole = std::floor(stamp_s);
    put(static_cast<std::int32_t>(whole));
    put(static_cast<std::uint32_t>(std::lround((stamp_s - whole) * 1e9)));
    return text(frame);
  }
  CdrWriter& pose(const RosPose& pose) {
    put(pose.x_m).put(pose.y_m).put(0.25);
    if (pose.is_upside_down) return put(1.0).put(0.0).put(0.0).put(0.0);
    return put(0.0).put(0.0).put(std::sin(0.5 * pose.yaw_rad)).put(std::cos(0.5 * pose.yaw_rad));
  }
  [[nodiscard]] std::string bytes() const {
    std::string head(4, '\0');
    head[1] = is_big_ ? '\0' : '\1';
    return head + bytes_;
  }

 private:
  bool is_big_;
  std::string bytes_;
};

inline std::string cdr_scan(const RosScan& scan, bool is_big = false) {
  CdrWriter cdr(is_big);
  cdr.header(scan.stamp_s, scan.frame).put(scan.first_rad).put(0.0F).put(scan.step_rad);
  cdr.put(scan.beam_period_s).put(0.1F).put(scan.least_m).put(scan.most_m);
  cdr.put(static_cast<std::uint32_t>(scan.ranges_m.size()));
  for (const float range_m : scan.ranges_m) cdr.put(range_m);
  return cdr.put(std::uint32_t{0}).bytes();
}
inline std::string cdr_echo_scan(const RosScan& scan, const std::vector<std::vector<float>>& echoes_m) {
  CdrWriter cdr;
  cdr.header(scan.stamp_s, scan.frame).put(scan.first_rad).put(0.0F).put(scan.step_rad);
  cdr.put(scan.beam_period_s).put(0.1F).put(scan.least_m).put(scan.most_m);
  cdr.put(static_cast<std::uint32_t>(echoes_m.size()));
  for (const std::vector<float>& beam : echoes_m) {
    cdr.put(static_cast<std::uint32_t>(beam.size()));
    for (const float range_m : beam) cdr.put(range_m);
  }
  return cdr.put(std::uint32_t{0}).bytes();
}
inline std::string cdr_odometry(double stamp_s, const RosPose& pose) {
  CdrWriter cdr;
  cdr.header(stamp_s, "odom").text("base_link").pose(pose);
  for (int k = 0; k < 36 + 6 + 36; ++k) cdr.put(0.0);
  return cdr.bytes();
}
inline std::string cdr_transform(double stamp_s, const std::string& parent, const std::string& child,
                                 const RosPose& pose) {
  return CdrWriter().put(std::uint32_t{1}).header(stamp_s, parent).text(child).pose(pose).bytes();
}
inline std::string cdr_joints(double stamp_s, const std::vector<std::string>& names,
                              const std::vector<double>& positions_rad) {
  CdrWriter cdr;
  cdr.header(stamp_s, "").put(static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) cdr.text(name);
  cdr.put(static_cast<std::uint32_t>(positions_rad.size()));
  for (const double position_rad : positions_rad) cdr.put(position_rad);
  return cdr.put(std::uint32_t{0}).put(std::uint32_t{0}).bytes();
}

}  // namespace gdtslam::test

// A ROS 1 bag of format 2.0 with its index (https://wiki.ros.org/Bags/Format/2.0): chunks of 768 KiB. Its first record
// tells where the index is, so it is written last and a pipe will not do. Memory: a chunk, and 100 bytes for each one
// written. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "log_writer.hpp"
#include "ros_container.hpp"

namespace gdtslam {

class Ros1BagWriter final : public RosContainer {
 public:
  /// `file` must outlive this.
  Ros1BagWriter(AtomicFile& file, ChunkPacking packing);
  [[nodiscard]] RosEncoding encoding() const override { return RosEncoding::kRos1; }
  std::uint32_t add_channel(const std::string& topic, RosType type, bool is_latched) override;
  void add(std::uint32_t channel, std::int64_t received_ns, std::string_view message) override;
  void finish() override;
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_; }

 private:
  struct IndexEntry {
    std::uint64_t received = 0;  ///< as the bag writes a time
    std::uint32_t offset = 0;    ///< in the unpacked chunk
  };
  void write(std::string_view bytes);
  void write_chunk();
  [[nodiscard]] std::string first_record(std::uint64_t index_begin) const;

  AtomicFile& file_;
  ChunkPacking packing_;
  std::uint64_t bytes_ = 0;
  std::vector<std::string> connections_;  ///< their records
  std::string chunk_;
  std::map<std::uint32_t, std::vector<IndexEntry>> chunk_index_;
  std::int64_t chunk_first_ns_ = 0;
  std::int64_t chunk_last_ns_ = 0;
  std::vector<std::string> chunk_records_;  ///< what the index tells of each chunk
};

}  // namespace gdtslam

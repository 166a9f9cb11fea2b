// An MCAP file (https://mcap.dev/spec) of ROS 2 messages in CDR: chunks of 1 MiB with their indexes and checksums, a
// summary with schemas, channels, statistics and the index of the chunks, so that viewers can seek. It is written
// forwards, so that it can go to a pipe. Memory: a chunk, and 100 bytes for each one written. One object belongs to one
// thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/logs/gzip_file.hpp"
#include "log_writer.hpp"
#include "ros_messages.hpp"

namespace gdtslam {

class McapWriter {
 public:
  /// `file` must outlive this.
  McapWriter(AtomicFile& file, ChunkPacking packing);
  /// Returns its number for add(). Players give the last message of a latched topic to every late listener.
  std::uint32_t add_channel(const std::string& topic, RosType type, bool is_latched);
  /// Adds a message with its time of receipt. Throws FileError, as finish() does.
  void add(std::uint32_t channel, std::int64_t received_ns, std::string_view message);
  void finish();
  [[nodiscard]] std::uint64_t bytes() const { return sink_.bytes(); }

 private:
  struct Channel {
    std::string record;
    std::uint64_t messages = 0;
  };
  struct IndexEntry {
    std::uint64_t received_ns = 0;
    std::uint64_t offset = 0;  ///< in the unpacked chunk
  };
  struct Times {
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    void widen(std::uint64_t ns, bool is_first);
  };
  void write(std::string_view bytes);
  void write_chunk();
  void write_message_indexes(std::string& chunk_index);
  [[nodiscard]] std::string statistics() const;
  void write_summary();

  TextSink sink_;
  ChunkPacking packing_;
  std::map<RosType, std::string> schemas_;  ///< their records
  std::vector<Channel> channels_;
  std::string chunk_;
  Times chunk_times_;
  std::map<std::uint32_t, std::vector<IndexEntry>> chunk_index_;
  std::vector<std::string> chunk_records_;  ///< the index of the chunks
  Times times_;
  std::uint64_t messages_ = 0;
  std::uint64_t chunk_messages_ = 0;
  unsigned long checksum_ = 0;  ///< checksum of the data so far
};

}  // namespace gdtslam

// Reads the records of an MCAP file in order, including those in chunks (none, lz4, zstd), without going back: also
// from a pipe, or from a cut file. The summary and index after the data are not needed. CRCs are checked if the file
// has them. One file belongs to one thread. Format: mcap.dev/spec.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "chunk.hpp"
#include "engine/io/byte_source.hpp"
#include "recording.hpp"

namespace gdtslam {

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

class McapFile final : public ForwardRecording {
 public:
  /// `source` is at the first byte of the file. Throws RecordingFault if it is no MCAP file of version 0.
  explicit McapFile(std::unique_ptr<ByteSource> source);

  std::optional<RecordingItem> next(const Wanted& wanted, const Warn& warn) override;

 private:
  struct Chunk {
    CountedBytes bytes;
    std::uint64_t stated_bytes = 0;  ///< unpacked
    std::uint32_t stated_crc = 0;    ///< 0: none
    std::uint64_t end = 0;           ///< in the file
  };
  void open_chunk(std::uint64_t size);
  void close_chunk();
  void take_schema(const std::string& content);
  RecordingItem read_channel(const std::string& content) const;
  RecordingItem read_message(std::uint64_t size, CountedBytes& bytes, const Wanted& wanted);
  void end_data(std::uint32_t crc);

  std::optional<Chunk> chunk_;
  bool is_over_ = false;
  std::map<std::uint16_t, std::string> schemas_;  ///< names of types
};

}  // namespace gdtslam

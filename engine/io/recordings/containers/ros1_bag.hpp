// Reads the records of a ROS 1 bag (format 2.0) in order, including those in chunks, without going back: also from a
// pipe, or from a bag without index. Chunks are unpacked while reading (none, bz2, lz4). One bag belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chunk.hpp"
#include "engine/io/byte_source.hpp"
#include "recording.hpp"

namespace gdtslam {

inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";

/// Fields of a header, "name=value", in the order of the file; they point into the text.
class BagFields {
 public:
  /// Throws RecordingFault for text without valid fields.
  explicit BagFields(std::string_view text);
  [[nodiscard]] std::optional<std::string_view> find(std::string_view name) const;
  /// Throws RecordingFault if the field is missing or has another size.
  [[nodiscard]] std::uint32_t u32(std::string_view name) const;
  [[nodiscard]] std::uint8_t u8(std::string_view name) const;

 private:
  std::vector<std::pair<std::string_view, std::string_view>> fields_;
};

class Ros1Bag final : public ForwardRecording {
 public:
  /// `source` is at the first line of the bag. Throws RecordingFault if it is no bag.
  explicit Ros1Bag(std::unique_ptr<ByteSource> source);

  std::optional<RecordingItem> next(const Wanted& wanted, const Warn& warn) override;

 private:
  void open_chunk(const BagFields& fields, std::uint32_t size);
  void close_chunk();
  static RecordingItem read_connection(const BagFields& fields, std::uint32_t size, CountedBytes& bytes);
  RecordingItem read_message(const BagFields& fields, std::uint32_t size, CountedBytes& bytes, const Wanted& wanted);

  std::optional<CountedBytes> chunk_;
  std::uint64_t chunk_end_ = 0;  ///< in the file
  std::string header_;
};

}  // namespace gdtslam

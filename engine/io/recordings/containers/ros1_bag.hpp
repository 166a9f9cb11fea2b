// The records of a ROS 1 bag (format 2.0) one after the other, those within chunks among them, without going back: a
// pipe will do, and so will a bag without index. Chunks are unpacked as they are read (none, bz2, lz4). One bag belongs
// to one thread.
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
  /// Throws RecordingFault for what are no fields.
  explicit BagFields(std::string_view text);
  [[nodiscard]] std::optional<std::string_view> find(std::string_view name) const;
  /// Throws RecordingFault where it is missing or of another size.
  [[nodiscard]] std::uint32_t u32(std::string_view name) const;
  [[nodiscard]] std::uint8_t u8(std::string_view name) const;

 private:
  std::vector<std::pair<std::string_view, std::string_view>> fields_;
};

class Ros1Bag final : public ForwardRecording {
 public:
  /// The source is before the first line of the bag. Throws RecordingFault where it is no bag.
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

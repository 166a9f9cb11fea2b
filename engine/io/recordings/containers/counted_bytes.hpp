// Bytes of a source with their number: as many as are asked for, or a RecordingCut. Little endian, as all containers
// of recordings are. One object belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/byte_source.hpp"
#include "recording.hpp"

namespace gdtslam {

/// The whole number that begins a text of at least its size.
template <class Whole>
Whole little_endian(const char* bytes) {
  Whole value = 0;
  for (std::size_t k = 0; k < sizeof(Whole); ++k) {
    value |= static_cast<Whole>(static_cast<Whole>(static_cast<unsigned char>(bytes[k])) << (8U * k));
  }
  return value;
}

class CountedBytes {
 public:
  explicit CountedBytes(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {}
  /// Bytes consumed so far.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  [[nodiscard]] const ByteSource& source() const { return *source_; }
  [[nodiscard]] bool at_end() { return begin_ == end_ && !fill(); }
  /// Up to so many bytes, 0 at the end only.
  std::size_t read_some(std::span<char> target);
  void read(std::span<char> target);
  template <class Whole>
  Whole read_whole() {
    char bytes[sizeof(Whole)];
    read(bytes);
    return little_endian<Whole>(bytes);
  }
  /// `count` bytes into `text`, which grows only as they arrive; `limit` is what is refused.
  void read_into(std::string& text, std::uint64_t count, std::size_t limit, const char* what);
  std::string read_text(std::uint64_t count, std::size_t limit, const char* what);
  void skip(std::uint64_t count);
  /// From here on crc() is known, at the price of a pass over the bytes.
  void start_crc();
  /// CRC-32 of the bytes consumed since start_crc().
  [[nodiscard]] std::uint32_t crc();

 private:
  bool fill();
  void consume(std::size_t count) {
    begin_ += count;
    offset_ += count;
  }

  // Small at first, for what is short, and doubled while reads fill it.
  static constexpr std::size_t kFirstPieceBytes = std::size_t{1} << 12U;
  static constexpr std::size_t kPieceBytes = std::size_t{1} << 16U;
  std::unique_ptr<ByteSource> source_;
  std::vector<char> buffer_ = std::vector<char>(kFirstPieceBytes);
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t offset_ = 0;
  bool has_crc_ = false;
  std::uint32_t crc_ = 0;      ///< up to crc_begin_
  std::size_t crc_begin_ = 0;  ///< in the buffer
};

}  // namespace gdtslam

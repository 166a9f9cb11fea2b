// Bytes of a recording and of its chunks, unpacked while reading. One object belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/byte_source.hpp"
#include "engine/io/little_endian.hpp"
#include "recording.hpp"

namespace gdtslam {

/// Counts the bytes of a source, and reads a given number or throws RecordingCut. Little endian, like all containers of
/// recordings.
class CountedBytes {
 public:
  explicit CountedBytes(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {}
  /// Bytes consumed so far.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  [[nodiscard]] const ByteSource& source() const { return *source_; }
  [[nodiscard]] bool at_end() { return begin_ == end_ && !fill(); }
  /// Fills at most the target; 0 only at the end.
  std::size_t read_some(std::span<char> target);
  void read(std::span<char> target);
  template <class Whole>
  Whole read_whole() {
    char bytes[sizeof(Whole)];
    read(bytes);
    return little_endian<Whole>(bytes);
  }
  /// Reads `count` bytes into `text`, which grows only as they arrive; refuses more than `limit`.
  void read_into(std::string& text, std::uint64_t count, std::size_t limit, const char* what);
  std::string read_text(std::uint64_t count, std::size_t limit, const char* what);
  void skip(std::uint64_t count);
  /// Starts the checksum for crc(), which costs a pass over the bytes.
  void start_crc();
  /// CRC-32 of the bytes consumed since start_crc().
  [[nodiscard]] std::uint32_t crc();

 private:
  bool fill();
  void consume(std::size_t count) {
    begin_ += count;
    offset_ += count;
  }

  // Small at first for short inputs, and doubled while reads fill it.
  static constexpr std::size_t kFirstPieceBytes = std::size_t{1} << 12U;
  static constexpr std::size_t kPieceBytes = std::size_t{1} << 16U;
  std::unique_ptr<ByteSource> source_;
  std::vector<char> buffer_ = std::vector<char>(kFirstPieceBytes);
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t offset_ = 0;
  bool has_crc_ = false;
  std::uint32_t crc_ = 0;      ///< checksum up to crc_begin_
  std::size_t crc_begin_ = 0;  ///< place in the buffer
};

/// The bytes of a file up to an end within it. Reading throws RecordingCut if the file ends before.
class ChunkBytes final : public ByteSource {
 public:
  ChunkBytes(CountedBytes& file, std::uint64_t end) : file_(file), end_(end) {}
  std::size_t read(std::span<char> target) override;
  [[nodiscard]] double progress() const override { return file_.source().progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return file_.source().bytes_from_file(); }

 private:
  CountedBytes& file_;
  std::uint64_t end_;
};

/// Unpacks a message that was packed alone (rosbag2's compression by message) into `buffer`. Others stay as they are,
/// because no CDR message begins like a zstd stream. Throws RecordingFault for a damaged or too long message.
std::string_view unpacked_message(std::string_view bytes, std::string& buffer);

/// `compression` from a chunk's header: none or empty, bz2, lz4 (frames) or zstd. Throws RecordingFault for another
/// one, with the container's `supported`; reading throws RecordingFault for damaged or cut data. Memory: as filled, up
/// to 128 MiB, the largest accepted window of zstd.
std::unique_ptr<ByteSource> unpacked_chunk(std::unique_ptr<ByteSource> packed, std::string_view compression,
                                           std::string_view supported);

/// A container that is read forwards, also from a pipe.
class ForwardRecording : public Recording {
 public:
  explicit ForwardRecording(std::unique_ptr<ByteSource> source) : file_(std::move(source)) {}
  [[nodiscard]] std::string place() const override { return "before byte " + std::to_string(file_.offset()); }
  [[nodiscard]] double progress() const override { return file_.source().progress(); }
  [[nodiscard]] std::string defect() const override { return file_.source().defect(); }

 protected:
  /// Reads the bytes of a message if its channel is wanted; skips others.
  void take_message(CountedBytes& bytes, std::uint64_t size, const Wanted& wanted, RecordingItem& item) {
    if (!wanted(item.channel)) return bytes.skip(size);
    bytes.read_into(content_, size, kMostMessageBytes, "a message");
    item.bytes = content_;
  }

  CountedBytes file_;
  std::string content_;  ///< bytes of the last message
};

}  // namespace gdtslam

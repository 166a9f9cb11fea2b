// The records of a ROS 1 bag (format 2.0) one after the other, those within chunks among them, without going back: a
// pipe will do, and so will a bag without index. Chunks are unpacked as they are read (none, bz2, lz4). Nothing is
// allocated for a number that the file states: memory grows with the bytes that have arrived, up to kMostBagMessage.
// One reader belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/byte_source.hpp"

namespace gdtslam {

inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
inline constexpr std::size_t kMostBagMessage = std::size_t{16} << 20U;
inline constexpr std::size_t kMostBagHeader = std::size_t{1} << 16U;

/// What is wrong with a bag, without file and place.
class BagFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// The bag ends in the middle of something.
class BagCut : public BagFault {
 public:
  using BagFault::BagFault;
};

/// Bytes of a source, counted, with as much as is asked for or a BagCut.
class BagBytes {
 public:
  explicit BagBytes(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {}
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  [[nodiscard]] const ByteSource& source() const { return *source_; }
  [[nodiscard]] bool at_end() { return begin_ == end_ && !fill(); }
  /// Up to so many bytes, 0 at the end only.
  std::size_t read_some(std::span<char> target);
  void read(std::span<char> target);
  std::uint32_t read_u32();
  /// `count` bytes, kept only as they arrive; `limit` is what is refused.
  std::string read_text(std::size_t count, std::size_t limit, const char* what);
  void skip(std::uint64_t count);

 private:
  bool fill();
  static constexpr std::size_t kBagPiece = std::size_t{1} << 16U;
  std::unique_ptr<ByteSource> source_;
  std::vector<char> buffer_ = std::vector<char>(kBagPiece);
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t offset_ = 0;
};

/// Fields of a header, "name=value", in the order of the file; they point into the text.
class BagFields {
 public:
  /// Throws BagFault for what are no fields.
  explicit BagFields(std::string_view text);
  [[nodiscard]] std::optional<std::string_view> find(std::string_view name) const;
  /// Throws BagFault where it is missing or of another size.
  [[nodiscard]] std::uint32_t u32(std::string_view name) const;
  [[nodiscard]] std::uint8_t u8(std::string_view name) const;

 private:
  std::vector<std::pair<std::string_view, std::string_view>> fields_;
};

struct BagRecord {
  bool is_connection = false;  ///< else a message
  std::uint32_t connection = 0;
  double received_s = 0.0;  ///< of a message: when the bag got it
  std::string topic;        ///< of a connection
  std::string data;         ///< of a connection its header, of a message its bytes, where it was wanted
};

class BagRecords {
 public:
  /// Whether the bytes of a connection's messages are wanted.
  using Wanted = std::function<bool(std::uint32_t connection)>;
  using Warn = std::function<void(std::string_view kind, const std::string& detail)>;
  /// The source is behind the first line of the bag, or before it. Throws BagFault where it is no bag.
  explicit BagRecords(std::unique_ptr<ByteSource> source);

  /// The next connection or message; nothing at the end. Throws BagCut or BagFault; skip_damage() can go on after that.
  std::optional<BagRecord> next(const Wanted& wanted, const Warn& warn);
  /// Leaves the damaged chunk; false where the damage is outside of chunks, or the bag ended in it.
  bool skip_damage();
  [[nodiscard]] std::uint64_t offset() const { return file_.offset(); }
  [[nodiscard]] const ByteSource& source() const { return file_.source(); }

 private:
  void open_chunk(const BagFields& fields, std::uint32_t size);
  void close_chunk();
  void skip_index(const BagFields& fields, std::uint32_t size, BagBytes& bytes, const Warn& warn);

  BagBytes file_;
  std::optional<BagBytes> chunk_;
  std::uint64_t chunk_end_ = 0;  ///< in the file
};

}  // namespace gdtslam

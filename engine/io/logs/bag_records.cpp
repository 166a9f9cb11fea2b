#include "bag_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "bag_chunk.hpp"
#include "engine/io/message_text.hpp"

namespace gdtslam {
namespace {

constexpr std::uint8_t kMessageOp = 0x02;
constexpr std::uint8_t kIndexOp = 0x04;
constexpr std::uint8_t kChunkOp = 0x05;
constexpr std::uint8_t kConnectionOp = 0x07;
constexpr std::uint64_t kIndexEntryBytes = 12;

/// ROS 1 is little endian everywhere.
std::uint32_t u32_of(const char* bytes) {
  std::uint32_t value = 0;
  for (unsigned k = 0; k < 4; ++k) value |= std::uint32_t{static_cast<unsigned char>(bytes[k])} << (8U * k);
  return value;
}

/// What is left of a chunk in the file.
class ChunkBytes final : public ByteSource {
 public:
  ChunkBytes(BagBytes& file, std::uint64_t end) : file_(file), end_(end) {}
  std::size_t read(std::span<char> target) override {
    const std::uint64_t left = end_ - file_.offset();
    if (left > 0 && file_.at_end()) throw BagCut("ends in the middle of a chunk");
    return file_.read_some(target.first(static_cast<std::size_t>(std::min<std::uint64_t>(target.size(), left))));
  }
  [[nodiscard]] double progress() const override { return file_.source().progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return file_.source().bytes_from_file(); }

 private:
  BagBytes& file_;
  std::uint64_t end_;
};

}  // namespace

bool BagBytes::fill() {
  begin_ = 0;
  end_ = source_->read(buffer_);
  return end_ > 0;
}

std::size_t BagBytes::read_some(std::span<char> target) {
  if (target.empty() || at_end()) return 0;
  const std::size_t count = std::min(target.size(), end_ - begin_);
  std::memcpy(target.data(), buffer_.data() + begin_, count);
  begin_ += count;
  offset_ += count;
  return count;
}

void BagBytes::read(std::span<char> target) {
  while (!target.empty()) {
    const std::size_t count = read_some(target);
    if (count == 0) throw BagCut("ends in the middle of a record");
    target = target.subspan(count);
  }
}

std::uint32_t BagBytes::read_u32() {
  std::array<char, 4> bytes{};
  read(bytes);
  return u32_of(bytes.data());
}

std::string BagBytes::read_text(std::size_t count, std::size_t limit, const char* what) {
  if (count > limit) throw BagFault(fmt::format("has {} of {} bytes; at most {} are read", what, count, limit));
  std::string text;
  while (text.size() < count) {
    const std::size_t begin = text.size();
    text.resize(begin + std::min(count - begin, kBagPiece));
    read({text.data() + begin, text.size() - begin});
  }
  return text;
}

void BagBytes::skip(std::uint64_t count) {
  while (count > 0) {
    if (at_end()) throw BagCut("ends in the middle of a record");
    const std::uint64_t step = std::min<std::uint64_t>(count, end_ - begin_);
    begin_ += static_cast<std::size_t>(step);
    offset_ += step;
    count -= step;
  }
}

BagFields::BagFields(std::string_view text) {
  while (!text.empty()) {
    if (text.size() < 4) throw BagFault("has a header that ends in the middle of a field");
    const std::size_t size = u32_of(text.data());
    text.remove_prefix(4);
    if (size > text.size()) throw BagFault("has a header whose field is longer than the header");
    const std::string_view field = text.substr(0, size);
    text.remove_prefix(size);
    const std::size_t middle = field.find('=');
    if (middle == std::string_view::npos) throw BagFault("has a header with a field that is no name=value");
    fields_.emplace_back(field.substr(0, middle), field.substr(middle + 1));
  }
}

std::optional<std::string_view> BagFields::find(std::string_view name) const {
  for (const auto& [known, value] : fields_) {
    if (known == name) return value;
  }
  return std::nullopt;
}

std::uint32_t BagFields::u32(std::string_view name) const {
  const std::optional<std::string_view> value = find(name);
  if (!value || value->size() != 4) throw BagFault(fmt::format("has a record without its field {}", name));
  return u32_of(value->data());
}

std::uint8_t BagFields::u8(std::string_view name) const {
  const std::optional<std::string_view> value = find(name);
  if (!value || value->size() != 1) throw BagFault(fmt::format("has a record without its field {}", name));
  return static_cast<std::uint8_t>(value->front());
}

BagRecords::BagRecords(std::unique_ptr<ByteSource> source) : file_(std::move(source)) {
  const std::string magic = file_.read_text(kBagMagic.size(), kBagMagic.size(), "a first line");
  if (magic != kBagMagic) {
    throw BagFault(fmt::format("begins with {}, which is no bag of version 2.0; 'rosbag migrate' makes one",
                               in_quotes(std::string_view(magic).substr(0, magic.size() - 1))));
  }
}

void BagRecords::open_chunk(const BagFields& fields, std::uint32_t size) {
  if (chunk_) throw BagFault("has a chunk within a chunk");
  chunk_end_ = file_.offset() + size;
  chunk_.emplace(
      unpacked_chunk(std::make_unique<ChunkBytes>(file_, chunk_end_), fields.find("compression").value_or("none")));
}

void BagRecords::close_chunk() {
  chunk_.reset();
  file_.skip(chunk_end_ - file_.offset());
}

bool BagRecords::skip_damage() {
  if (!chunk_) return false;
  chunk_.reset();
  try {
    file_.skip(chunk_end_ - file_.offset());
  } catch (const BagCut&) {
    return false;
  }
  return true;
}

// Some writers state a length that is wrong; the number of entries is right in all bags that were seen.
void BagRecords::skip_index(const BagFields& fields, std::uint32_t size, BagBytes& bytes, const Warn& warn) {
  const std::uint64_t counted = kIndexEntryBytes * fields.u32("count");
  if (counted != size) {
    warn("index of a wrong length", fmt::format("{} bytes are stated, its entries have {}", size, counted));
  }
  bytes.skip(counted);
}

std::optional<BagRecord> BagRecords::next(const Wanted& wanted, const Warn& warn) {
  while (true) {
    if (chunk_ && chunk_->at_end()) close_chunk();
    BagBytes& bytes = chunk_ ? *chunk_ : file_;
    if (bytes.at_end()) return std::nullopt;
    const std::string header = bytes.read_text(bytes.read_u32(), kMostBagHeader, "a header");
    const BagFields fields(header);
    const std::uint8_t op = fields.u8("op");
    const std::uint32_t size = bytes.read_u32();
    if (op == kChunkOp) {
      open_chunk(fields, size);
    } else if (op == kIndexOp) {
      skip_index(fields, size, bytes, warn);
    } else if (op == kConnectionOp) {
      BagRecord record;
      record.is_connection = true;
      record.connection = fields.u32("conn");
      record.topic = std::string(fields.find("topic").value_or(""));
      record.data = bytes.read_text(size, kMostBagMessage, "a connection");
      return record;
    } else if (op == kMessageOp) {
      BagRecord record;
      record.connection = fields.u32("conn");
      const std::string_view time = fields.find("time").value_or("");
      if (time.size() != 8) throw BagFault("has a message without its time");
      record.received_s = u32_of(time.data()) + 1.0e-9 * u32_of(time.data() + 4);
      if (wanted(record.connection)) {
        record.data = bytes.read_text(size, kMostBagMessage, "a message");
      } else {
        bytes.skip(size);
      }
      return record;
    } else {
      bytes.skip(size);  // the bag's header, chunk information, and what later versions may add
    }
  }
}

}  // namespace gdtslam

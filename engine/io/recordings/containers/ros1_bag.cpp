#include "ros1_bag.hpp"

#include <fmt/format.h>

#include "engine/io/message_text.hpp"

namespace gdtslam {
namespace {

constexpr std::uint8_t kMessageOp = 0x02;
constexpr std::uint8_t kIndexOp = 0x04;
constexpr std::uint8_t kChunkOp = 0x05;
constexpr std::uint8_t kConnectionOp = 0x07;
constexpr std::uint64_t kIndexEntryBytes = 12;

// Some writers state a wrong length; the number of entries is right in all known bags.
void skip_index(const BagFields& fields, std::uint32_t size, CountedBytes& bytes, const Recording::Warn& warn) {
  const std::uint64_t counted = kIndexEntryBytes * fields.u32("count");
  if (counted != size) {
    warn("index of a wrong length", fmt::format("{} bytes are stated, its entries have {}", size, counted));
  }
  bytes.skip(counted);
}

}  // namespace

BagFields::BagFields(std::string_view text) {
  while (!text.empty()) {
    if (text.size() < 4) throw RecordingFault("has a header that ends in the middle of a field");
    const std::size_t size = little_endian<std::uint32_t>(text.data());
    text.remove_prefix(4);
    if (size > text.size()) throw RecordingFault("has a header whose field is longer than the header");
    const std::string_view field = text.substr(0, size);
    text.remove_prefix(size);
    const std::size_t middle = field.find('=');
    if (middle == std::string_view::npos) throw RecordingFault("has a header with a field that is no name=value");
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
  if (!value || value->size() != 4) throw RecordingFault(fmt::format("has a record without its field {}", name));
  return little_endian<std::uint32_t>(value->data());
}

std::uint8_t BagFields::u8(std::string_view name) const {
  const std::optional<std::string_view> value = find(name);
  if (!value || value->size() != 1) throw RecordingFault(fmt::format("has a record without its field {}", name));
  return static_cast<std::uint8_t>(value->front());
}

Ros1Bag::Ros1Bag(std::unique_ptr<ByteSource> source) : ForwardRecording(std::move(source)) {
  const std::string magic = file_.read_text(kBagMagic.size(), kBagMagic.size(), "a first line");
  if (magic != kBagMagic) {
    throw RecordingFault(fmt::format("begins with {}, which is no bag of version 2.0; 'rosbag migrate' makes one",
                                     in_quotes(std::string_view(magic).substr(0, magic.size() - 1))));
  }
}

void Ros1Bag::open_chunk(const BagFields& fields, std::uint32_t size) {
  if (chunk_) throw RecordingFault("has a chunk within a chunk");
  chunk_end_ = file_.offset() + size;
  chunk_.emplace(unpacked_chunk(std::make_unique<ChunkBytes>(file_, chunk_end_),
                                fields.find("compression").value_or("none"), "none, bz2 and lz4"));
}

void Ros1Bag::close_chunk() {
  chunk_.reset();
  file_.skip(chunk_end_ - file_.offset());
}

RecordingItem Ros1Bag::read_connection(const BagFields& fields, std::uint32_t size, CountedBytes& bytes) {
  const std::string text = bytes.read_text(size, kMostMessageBytes, "a connection");
  const BagFields described(text);
  RecordingItem item{.channel = fields.u32("conn")};
  RecordingChannel channel;
  const std::optional<std::string_view> topic = fields.find("topic");
  channel.topic = std::string(topic && !topic->empty() ? *topic : described.find("topic").value_or(""));
  channel.type = std::string(described.find("type").value_or("*"));
  channel.md5 = std::string(described.find("md5sum").value_or(""));
  channel.encoding_name = "ros1";
  channel.encoding = MessageEncoding::kRos1;
  item.definition = std::move(channel);
  return item;
}

RecordingItem Ros1Bag::read_message(const BagFields& fields, std::uint32_t size, CountedBytes& bytes,
                                    const Wanted& wanted) {
  RecordingItem item{.channel = fields.u32("conn")};
  const std::string_view time = fields.find("time").value_or("");
  if (time.size() != 8) throw RecordingFault("has a message without its time");
  item.received_s = little_endian<std::uint32_t>(time.data()) + 1.0e-9 * little_endian<std::uint32_t>(time.data() + 4);
  take_message(bytes, size, wanted, item);
  return item;
}

std::optional<RecordingItem> Ros1Bag::next(const Wanted& wanted, const Warn& warn) {
  while (true) {
    if (chunk_ && chunk_->at_end()) close_chunk();
    CountedBytes& bytes = chunk_ ? *chunk_ : file_;
    if (bytes.at_end()) return std::nullopt;
    bytes.read_into(header_, bytes.read_whole<std::uint32_t>(), kMostHeaderBytes, "a header");
    const BagFields fields(header_);
    const std::uint8_t op = fields.u8("op");
    const auto size = bytes.read_whole<std::uint32_t>();
    if (op == kChunkOp) {
      open_chunk(fields, size);
    } else if (op == kIndexOp) {
      skip_index(fields, size, bytes, warn);
    } else if (op == kConnectionOp) {
      return read_connection(fields, size, bytes);
    } else if (op == kMessageOp) {
      return read_message(fields, size, bytes, wanted);
    } else {
      bytes.skip(size);  // the bag's header, chunk information, and records of later versions
    }
  }
}

}  // namespace gdtslam

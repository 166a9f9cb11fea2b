#include "mcap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "engine/io/message_text.hpp"

namespace gdtslam {
namespace {

enum McapOp : std::uint8_t {
  kMcapFooter = 0x02,
  kMcapSchema = 0x03,
  kMcapChannel = 0x04,
  kMcapMessage = 0x05,
  kMcapChunk = 0x06,
  kMcapDataEnd = 0x0f,
};
constexpr std::uint64_t kMessageHeadBytes = 2 + 4 + 8 + 8;
constexpr std::uint64_t kChunkHeadBytes = 8 + 8 + 8 + 4 + 4;
constexpr std::uint64_t kDataEndBytes = 4;
constexpr std::uint64_t kMostChunkBytes = std::uint64_t{1} << 30U;
constexpr std::size_t kMostChunkHeadText = 64;  // the name of a compression

/// Reads the fields of a record in order.
class McapFields {
 public:
  explicit McapFields(std::string_view content) : content_(content) {}
  template <class Whole>
  Whole whole() {
    return little_endian<Whole>(take(sizeof(Whole)).data());
  }
  std::string_view text() { return take(whole<std::uint32_t>()); }

 private:
  std::string_view take(std::size_t count) {
    if (count > content_.size()) throw RecordingFault("has a record whose fields are longer than the record");
    const std::string_view taken = content_.substr(0, count);
    content_.remove_prefix(count);
    return taken;
  }
  std::string_view content_;
};

double mcap_seconds(std::uint64_t time_ns) {
  constexpr std::uint64_t kSecond_ns = 1'000'000'000;
  const std::uint64_t whole_s = time_ns / kSecond_ns;
  return static_cast<double>(whole_s) + 1.0e-9 * static_cast<double>(time_ns % kSecond_ns);
}

MessageEncoding mcap_encoding(std::string_view name) {
  if (name == "ros1") return MessageEncoding::kRos1;
  return name == "cdr" ? MessageEncoding::kCdr : MessageEncoding::kOther;
}

}  // namespace

McapFile::McapFile(std::unique_ptr<ByteSource> source) : ForwardRecording(std::move(source)) {
  file_.start_crc();
  const std::string magic = file_.read_text(kMcapMagic.size(), kMcapMagic.size(), "a first line");
  if (magic != kMcapMagic) {
    throw RecordingFault(fmt::format("begins with {}, which is no MCAP file of version 0", in_quotes(magic)));
  }
}

void McapFile::open_chunk(std::uint64_t size) {
  if (chunk_) throw RecordingFault("has a chunk within a chunk");
  if (size < kChunkHeadBytes) throw RecordingFault("has a chunk shorter than its own fields");
  file_.skip(8 + 8);  // the times of its first and last message
  const auto unpacked_bytes = file_.read_whole<std::uint64_t>();
  const auto crc = file_.read_whole<std::uint32_t>();
  const auto name_bytes = file_.read_whole<std::uint32_t>();
  const std::string compression = file_.read_text(name_bytes, kMostChunkHeadText, "the name of a compression");
  const auto packed_bytes = file_.read_whole<std::uint64_t>();
  if (packed_bytes != size - (kChunkHeadBytes + 8 + name_bytes)) {
    throw RecordingFault("has a chunk whose lengths contradict each other");
  }
  if (unpacked_bytes > kMostChunkBytes) {
    throw RecordingFault(
        fmt::format("has a chunk of {} bytes; at most {} are unpacked", unpacked_bytes, kMostChunkBytes));
  }
  const std::uint64_t end = file_.offset() + packed_bytes;
  auto packed = std::make_unique<ChunkBytes>(file_, end);
  chunk_.emplace(Chunk{.bytes = CountedBytes(unpacked_chunk(std::move(packed), compression, "none, lz4 and zstd")),
                       .stated_bytes = unpacked_bytes,
                       .stated_crc = crc,
                       .end = end});
  if (crc != 0) chunk_->bytes.start_crc();
}

void McapFile::close_chunk() {
  if (chunk_->bytes.offset() != chunk_->stated_bytes) {
    throw RecordingFault(fmt::format("has a chunk that unpacks to {} bytes and states {}", chunk_->bytes.offset(),
                                     chunk_->stated_bytes));
  }
  if (chunk_->stated_crc != 0 && chunk_->bytes.crc() != chunk_->stated_crc) {
    throw RecordingFault("has a chunk that was changed: its CRC is wrong");
  }
  const std::uint64_t end = chunk_->end;
  chunk_.reset();
  file_.skip(end - file_.offset());
}

void McapFile::take_schema(const std::string& content) {
  McapFields fields(content);
  const auto number = fields.whole<std::uint16_t>();
  const std::string_view name = fields.text();
  if (number != 0 && name.size() <= kMostHeaderBytes) schemas_.emplace(number, name);
}

RecordingItem McapFile::read_channel(const std::string& content) const {
  McapFields fields(content);
  RecordingItem item{.channel = fields.whole<std::uint16_t>()};
  const auto schema = schemas_.find(fields.whole<std::uint16_t>());
  RecordingChannel channel;
  channel.topic = std::string(fields.text());
  channel.type = schema == schemas_.end() ? "*" : schema->second;
  channel.encoding_name = std::string(fields.text());
  channel.encoding = mcap_encoding(channel.encoding_name);
  item.definition = std::move(channel);
  return item;
}

RecordingItem McapFile::read_message(std::uint64_t size, CountedBytes& bytes, const Wanted& wanted) {
  if (size < kMessageHeadBytes) throw RecordingFault("has a message shorter than its own fields");
  std::array<char, kMessageHeadBytes> head{};
  bytes.read(head);
  RecordingItem item{.channel = little_endian<std::uint16_t>(head.data())};
  item.received_s = mcap_seconds(little_endian<std::uint64_t>(head.data() + 2 + 4));
  take_message(bytes, size - kMessageHeadBytes, wanted, item);
  return item;
}

// Checks the CRC over all data before the record that ends them.
void McapFile::end_data(std::uint32_t crc) {
  const auto stated = file_.read_whole<std::uint32_t>();
  is_over_ = true;
  if (stated != 0 && stated != crc) throw RecordingFault("was changed: the CRC of its data is wrong");
}

std::optional<RecordingItem> McapFile::next(const Wanted& wanted, const Warn& /*warn*/) {
  while (!is_over_) {
    if (chunk_ && chunk_->bytes.at_end()) {
      close_chunk();
      continue;
    }
    CountedBytes& bytes = chunk_ ? chunk_->bytes : file_;
    if (chunk_ && bytes.offset() > chunk_->stated_bytes) throw RecordingFault("has a chunk longer than it states");
    if (bytes.at_end()) throw RecordingCut("ends without the record that ends its data");
    const std::uint32_t crc = chunk_ ? 0 : file_.crc();
    const auto op = bytes.read_whole<std::uint8_t>();
    const auto size = bytes.read_whole<std::uint64_t>();
    if (chunk_ && size > chunk_->stated_bytes - std::min(chunk_->stated_bytes, bytes.offset())) {
      throw RecordingFault("has a record that is longer than its chunk");
    }
    if (op == kMcapMessage) return read_message(size, bytes, wanted);
    if (op == kMcapChunk) {
      open_chunk(size);
    } else if (op == kMcapSchema) {
      bytes.read_into(content_, size, kMostMessageBytes, "a schema");
      take_schema(content_);
    } else if (op == kMcapChannel) {
      bytes.read_into(content_, size, kMostMessageBytes, "a channel");
      return read_channel(content_);
    } else if (op == kMcapDataEnd && !chunk_ && size == kDataEndBytes) {
      end_data(crc);
    } else if (op == kMcapFooter && !chunk_) {
      is_over_ = true;
    } else {
      bytes.skip(size);
    }
  }
  return std::nullopt;
}

}  // namespace gdtslam

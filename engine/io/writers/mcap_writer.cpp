#include "mcap_writer.hpp"

#include <fmt/format.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "engine/io/little_endian.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMcapChunkBytes = std::size_t{1} << 20U;
constexpr std::string_view kWrittenMcapMagic = "\x89MCAP0\r\n";

enum class McapWritten : unsigned char {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f
};

void append_mcap_text(std::string& bytes, std::string_view text) {
  append_little_endian(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

std::string mcap_record(McapWritten opcode, std::string_view content) {
  std::string record(1, static_cast<char>(opcode));
  append_little_endian(record, static_cast<std::uint64_t>(content.size()));
  return record.append(content);
}

unsigned long update_checksum(std::string_view bytes, unsigned long before = 0) {
  return crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
}

/// How ROS 2 names the quality of service of a topic: reliable; latched ones keep their last message.
std::string ros2_service_quality(bool is_latched) {
  constexpr std::string_view kForever = "\n    sec: 9223372036\n    nsec: 854775807\n";
  return fmt::format(
      "- history: 1\n  depth: {}\n  reliability: 1\n  durability: {}\n  deadline:{}  lifespan:{}  liveliness: 1\n"
      "  liveliness_lease_duration:{}  avoid_ros_namespace_conventions: false",
      is_latched ? 1 : 10, is_latched ? 1 : 2, kForever, kForever, kForever);
}

[[noreturn]] void refuse_packing(ChunkPacking packing) {
  throw Error(ExitCode::kFailed, std::string(packing_name(packing)) + " cannot pack a chunk (out of memory)");
}

std::string lz4_packed(const std::string& bytes) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string packed(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  const std::size_t size = LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
  if (LZ4F_isError(size) != 0U) refuse_packing(ChunkPacking::kLz4);
  packed.resize(size);
  return packed;
}

std::string zstd_packed(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size) != 0U) refuse_packing(ChunkPacking::kZstd);
  packed.resize(size);
  return packed;
}

}  // namespace

std::string_view packing_name(ChunkPacking packing) {
  constexpr std::array<std::string_view, 3> kPackingNames{"none", "lz4", "zstd"};
  return kPackingNames[static_cast<std::size_t>(packing)];
}

std::string packed_chunk(const std::string& bytes, ChunkPacking packing) {
  if (packing == ChunkPacking::kLz4) return lz4_packed(bytes);
  return packing == ChunkPacking::kZstd ? zstd_packed(bytes) : bytes;
}

void McapWriter::Times::widen(std::uint64_t ns, bool is_first) {
  first_ns = is_first ? ns : std::min(first_ns, ns);
  last_ns = is_first ? ns : std::max(last_ns, ns);
}

McapWriter::McapWriter(AtomicFile& file, ChunkPacking packing) : sink_(file), packing_(packing) {
  std::string content;
  append_mcap_text(content, "ros2");
  append_mcap_text(content, "gdtslam");
  write(kWrittenMcapMagic);
  write(mcap_record(McapWritten::kHeader, content));
}

void McapWriter::write(std::string_view bytes) {
  checksum_ = update_checksum(bytes, checksum_);
  sink_.write(bytes);
}

std::uint32_t McapWriter::add_channel(const std::string& topic, RosType type, bool is_latched) {
  if (!schemas_.contains(type)) {
    std::string schema;
    append_little_endian(schema, static_cast<std::uint16_t>(static_cast<unsigned>(type) + 1));  // 0 means none
    append_mcap_text(schema, ros_type_name(type));
    append_mcap_text(schema, "ros2msg");
    append_mcap_text(schema, ros_definition(type));
    chunk_ += schemas_.emplace(type, mcap_record(McapWritten::kSchema, schema)).first->second;
  }
  const auto number = static_cast<std::uint32_t>(channels_.size());
  std::string quality;
  append_mcap_text(quality, "offered_qos_profiles");
  append_mcap_text(quality, ros2_service_quality(is_latched));
  std::string channel;
  append_little_endian(channel, static_cast<std::uint16_t>(number));
  append_little_endian(channel, static_cast<std::uint16_t>(static_cast<unsigned>(type) + 1));
  append_mcap_text(channel, topic);
  append_mcap_text(channel, "cdr");
  append_mcap_text(channel, quality);
  channels_.push_back({mcap_record(McapWritten::kChannel, channel)});
  chunk_ += channels_.back().record;
  return number;
}

void McapWriter::add(std::uint32_t channel, std::int64_t received_ns, std::string_view message) {
  const auto time_ns = static_cast<std::uint64_t>(received_ns);
  chunk_times_.widen(time_ns, chunk_messages_ == 0);
  times_.widen(time_ns, messages_ == 0);
  chunk_index_[channel].push_back({time_ns, chunk_.size()});
  std::string content;
  append_little_endian(content, static_cast<std::uint16_t>(channel));
  append_little_endian(content, static_cast<std::uint32_t>(channels_[channel].messages));
  append_little_endian(content, time_ns);
  append_little_endian(content, time_ns);
  content += message;
  chunk_ += mcap_record(McapWritten::kMessage, content);
  ++channels_[channel].messages;
  ++chunk_messages_;
  ++messages_;
  if (chunk_.size() >= kMcapChunkBytes) write_chunk();
}

void McapWriter::write_chunk() {
  if (chunk_.empty()) return;
  const std::string_view name = packing_ == ChunkPacking::kNone ? "" : packing_name(packing_);
  const std::string records = packed_chunk(chunk_, packing_);
  std::string chunk;
  append_little_endian(chunk, chunk_times_.first_ns);
  append_little_endian(chunk, chunk_times_.last_ns);
  append_little_endian(chunk, static_cast<std::uint64_t>(chunk_.size()));
  append_little_endian(chunk, static_cast<std::uint32_t>(update_checksum(chunk_)));
  append_mcap_text(chunk, name);
  append_little_endian(chunk, static_cast<std::uint64_t>(records.size()));
  chunk += records;
  const std::string record = mcap_record(McapWritten::kChunk, chunk);
  std::string index;
  append_little_endian(index, chunk_times_.first_ns);
  append_little_endian(index, chunk_times_.last_ns);
  append_little_endian(index, sink_.bytes());
  append_little_endian(index, static_cast<std::uint64_t>(record.size()));
  write(record);
  write_message_indexes(index);
  append_mcap_text(index, name);
  append_little_endian(index, static_cast<std::uint64_t>(records.size()));
  append_little_endian(index, static_cast<std::uint64_t>(chunk_.size()));
  chunk_records_.push_back(mcap_record(McapWritten::kChunkIndex, index));
  chunk_.clear();
  chunk_messages_ = 0;
}

// Writes an index for each channel after the chunk, and their places to the index of the chunk.
void McapWriter::write_message_indexes(std::string& chunk_index) {
  const std::uint64_t begin = sink_.bytes();
  std::string places;
  for (const auto& [channel, entries] : chunk_index_) {
    append_little_endian(places, static_cast<std::uint16_t>(channel));
    append_little_endian(places, sink_.bytes());
    std::string rows;
    for (const IndexEntry& entry : entries) {
      append_little_endian(rows, entry.received_ns);
      append_little_endian(rows, entry.offset);
    }
    std::string content;
    append_little_endian(content, static_cast<std::uint16_t>(channel));
    append_mcap_text(content, rows);
    write(mcap_record(McapWritten::kMessageIndex, content));
  }
  chunk_index_.clear();
  append_mcap_text(chunk_index, places);
  append_little_endian(chunk_index, sink_.bytes() - begin);
}

std::string McapWriter::statistics() const {
  std::string content;
  append_little_endian(content, messages_);
  append_little_endian(content, static_cast<std::uint16_t>(schemas_.size()));
  append_little_endian(content, static_cast<std::uint32_t>(channels_.size()));
  append_little_endian(content, std::uint32_t{0});  // attachments
  append_little_endian(content, std::uint32_t{0});  // metadata
  append_little_endian(content, static_cast<std::uint32_t>(chunk_records_.size()));
  append_little_endian(content, times_.first_ns);
  append_little_endian(content, times_.last_ns);
  std::string counts;
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    append_little_endian(counts, static_cast<std::uint16_t>(channel));
    append_little_endian(counts, channels_[channel].messages);
  }
  append_mcap_text(content, counts);
  return mcap_record(McapWritten::kStatistics, content);
}

void McapWriter::write_summary() {
  const std::uint64_t begin = sink_.bytes();
  std::string summary;
  std::string offsets;
  const auto add_group = [&](McapWritten opcode, const auto& add_records) {
    const std::size_t before = summary.size();
    add_records();
    if (summary.size() == before) return;
    std::string content(1, static_cast<char>(opcode));
    append_little_endian(content, begin + before);
    append_little_endian(content, static_cast<std::uint64_t>(summary.size() - before));
    offsets += mcap_record(McapWritten::kSummaryOffset, content);
  };
  add_group(McapWritten::kSchema, [&] {
    for (const auto& [type, record] : schemas_) summary += record;
  });
  add_group(McapWritten::kChannel, [&] {
    for (const Channel& channel : channels_) summary += channel.record;
  });
  add_group(McapWritten::kStatistics, [&] { summary += statistics(); });
  add_group(McapWritten::kChunkIndex, [&] {
    for (const std::string& record : chunk_records_) summary += record;
  });
  std::string footer;
  append_little_endian(footer, begin);
  append_little_endian(footer, begin + summary.size());
  summary += offsets;
  // The checksum of the summary includes the footer up to itself.
  std::string record = mcap_record(McapWritten::kFooter, footer + std::string(4, '\0'));
  record.resize(record.size() - 4);
  append_little_endian(record, static_cast<std::uint32_t>(update_checksum(record, update_checksum(summary))));
  write(summary);
  write(record);
}

void McapWriter::finish() {
  write_chunk();
  std::string content;
  append_little_endian(content, static_cast<std::uint32_t>(checksum_));
  write(mcap_record(McapWritten::kDataEnd, content));
  write_summary();
  write(kWrittenMcapMagic);
  sink_.finish();
}

}  // namespace gdtslam

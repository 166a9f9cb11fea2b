#include "ros1_bag_writer.hpp"

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "chunk_packer.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kBagChunkBytes = std::size_t{768} << 10U;
constexpr std::string_view kWrittenBagMagic = "#ROSBAG V2.0\n";
constexpr std::size_t kFirstRecordBytes = 4096;  // with its blanks, so that it can be written again

enum class BagWritten : unsigned char {
  kMessage = 2,
  kHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

using WrittenBagField = std::pair<std::string_view, std::string>;

template <class Whole>
std::string whole_bytes(Whole value) {
  std::string bytes;
  append_whole(bytes, value);
  return bytes;
}

/// Seconds, then nanoseconds.
std::uint64_t bag_time(std::int64_t ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  return static_cast<std::uint64_t>(ns / kSecond_ns) | (static_cast<std::uint64_t>(ns % kSecond_ns) << 32U);
}

std::string bag_fields(const std::vector<WrittenBagField>& fields) {
  std::string bytes;
  for (const auto& [name, value] : fields) {
    append_whole(bytes, static_cast<std::uint32_t>(name.size() + 1 + value.size()));
    bytes.append(name).append("=").append(value);
  }
  return bytes;
}

/// Up to its data, of which only the length is there.
std::string bag_record_head(BagWritten opcode, std::vector<WrittenBagField> fields, std::size_t data_bytes) {
  fields.emplace_back("op", std::string(1, static_cast<char>(opcode)));
  const std::string header = bag_fields(fields);
  std::string record = whole_bytes(static_cast<std::uint32_t>(header.size())) + header;
  append_whole(record, static_cast<std::uint32_t>(data_bytes));
  return record;
}

std::string bag_record(BagWritten opcode, std::vector<WrittenBagField> fields, std::string_view data) {
  return bag_record_head(opcode, std::move(fields), data.size()).append(data);
}

}  // namespace

Ros1BagWriter::Ros1BagWriter(AtomicFile& file, ChunkPacking packing) : file_(file), packing_(packing) {
  write(std::string(kWrittenBagMagic) + first_record(0));
}

void Ros1BagWriter::write(std::string_view bytes) {
  bytes_ += bytes.size();
  file_.write(bytes);
}

std::string Ros1BagWriter::first_record(std::uint64_t index_begin) const {
  std::string record =
      bag_record_head(BagWritten::kHeader,
                      {{"index_pos", whole_bytes(index_begin)},
                       {"conn_count", whole_bytes(static_cast<std::uint32_t>(connections_.size()))},
                       {"chunk_count", whole_bytes(static_cast<std::uint32_t>(chunk_records_.size()))}},
                      0);
  const std::size_t blanks = kFirstRecordBytes - record.size();
  record.resize(record.size() - sizeof(std::uint32_t));
  append_whole(record, static_cast<std::uint32_t>(blanks));
  return record.append(blanks, ' ');
}

std::uint32_t Ros1BagWriter::add_channel(const std::string& topic, RosType type, bool is_latched) {
  const auto number = static_cast<std::uint32_t>(connections_.size());
  std::vector<WrittenBagField> about{{"topic", topic},
                                     {"type", ros_type_name(type, RosEncoding::kRos1)},
                                     {"md5sum", std::string(ros_md5(type))},
                                     {"message_definition", ros_definition(type, RosEncoding::kRos1)}};
  if (is_latched) {
    about.emplace_back("callerid", "/gdtslam");
    about.emplace_back("latching", "1");
  }
  connections_.push_back(
      bag_record(BagWritten::kConnection, {{"conn", whole_bytes(number)}, {"topic", topic}}, bag_fields(about)));
  chunk_ += connections_.back();
  return number;
}

void Ros1BagWriter::add(std::uint32_t channel, std::int64_t received_ns, std::string_view message) {
  const bool is_first = chunk_index_.empty();
  chunk_first_ns_ = is_first ? received_ns : std::min(chunk_first_ns_, received_ns);
  chunk_last_ns_ = is_first ? received_ns : std::max(chunk_last_ns_, received_ns);
  const std::uint64_t time = bag_time(received_ns);
  chunk_index_[channel].push_back({time, static_cast<std::uint32_t>(chunk_.size())});
  chunk_ += bag_record(BagWritten::kMessage, {{"conn", whole_bytes(channel)}, {"time", whole_bytes(time)}}, message);
  if (chunk_.size() >= kBagChunkBytes) write_chunk();
}

void Ros1BagWriter::write_chunk() {
  if (chunk_.empty()) return;
  const std::uint64_t begin = bytes_;
  const std::string data = packed_chunk(chunk_, packing_);
  write(bag_record(BagWritten::kChunk,
                   {{"compression", std::string(packing_name(packing_))},
                    {"size", whole_bytes(static_cast<std::uint32_t>(chunk_.size()))}},
                   data));
  std::string counts;
  for (const auto& [channel, entries] : chunk_index_) {
    std::string rows;
    for (const IndexEntry& entry : entries) {
      append_whole(rows, entry.received);
      append_whole(rows, entry.offset);
    }
    const auto count = static_cast<std::uint32_t>(entries.size());
    write(bag_record(
        BagWritten::kIndex,
        {{"ver", whole_bytes(std::uint32_t{1})}, {"conn", whole_bytes(channel)}, {"count", whole_bytes(count)}}, rows));
    append_whole(counts, channel);
    append_whole(counts, count);
  }
  chunk_records_.push_back(bag_record(BagWritten::kChunkInfo,
                                      {{"ver", whole_bytes(std::uint32_t{1})},
                                       {"chunk_pos", whole_bytes(begin)},
                                       {"start_time", whole_bytes(bag_time(chunk_first_ns_))},
                                       {"end_time", whole_bytes(bag_time(chunk_last_ns_))},
                                       {"count", whole_bytes(static_cast<std::uint32_t>(chunk_index_.size()))}},
                                      counts));
  chunk_index_.clear();
  chunk_.clear();
}

void Ros1BagWriter::finish() {
  write_chunk();
  const std::uint64_t index_begin = bytes_;
  for (const std::string& record : connections_) write(record);
  for (const std::string& record : chunk_records_) write(record);
  file_.rewrite_begin(std::string(kWrittenBagMagic) + first_record(index_begin));
}

}  // namespace gdtslam

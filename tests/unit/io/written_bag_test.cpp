// What a bag says of itself, by the page of its format (wiki.ros.org/Bags/Format/2.0), and how chunks are packed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bag_writer.hpp"
#include "engine/io/recordings/containers/chunk.hpp"
#include "engine/io/writers/chunk_packer.hpp"
#include "engine/io/writers/ros1_bag_writer.hpp"
#include "gdtslam/core/random.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using testing::ElementsAre;

constexpr std::size_t kBagMagicBytes = 13;  // "#ROSBAG V2.0" and a line end
constexpr std::size_t kBagChunkLimit = std::size_t{768} << 10U;

std::uint64_t whole_of(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[k])) << (8U * k);
  }
  return value;
}

struct BagSpecRecord {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::map<std::string, std::string> fields{};
  std::string data{};
  [[nodiscard]] char op() const { return fields.at("op").at(0); }
  [[nodiscard]] std::uint64_t whole(const std::string& name) const { return whole_of(fields.at(name)); }
};

std::map<std::string, std::string> bag_spec_fields(std::string_view header) {
  std::map<std::string, std::string> fields;
  while (header.size() >= 4) {
    const std::string field(header.substr(4, whole_of(header.substr(0, 4))));
    fields[field.substr(0, field.find('='))] = field.substr(field.find('=') + 1);
    header.remove_prefix(4 + field.size());
  }
  EXPECT_TRUE(header.empty());
  return fields;
}

std::vector<BagSpecRecord> bag_spec_records(const std::string& bytes, std::size_t begin) {
  std::vector<BagSpecRecord> records;
  while (begin + 8 <= bytes.size()) {
    BagSpecRecord record{.begin = begin};
    const std::size_t header_bytes = whole_of(std::string_view(bytes).substr(begin, 4));
    record.fields = bag_spec_fields(std::string_view(bytes).substr(begin + 4, header_bytes));
    const std::size_t data_begin = begin + 4 + header_bytes + 4;
    record.data = bytes.substr(data_begin, whole_of(std::string_view(bytes).substr(data_begin - 4, 4)));
    begin = record.end = data_begin + record.data.size();
    records.push_back(std::move(record));
  }
  EXPECT_EQ(begin, bytes.size());
  return records;
}

std::vector<BagSpecRecord> of_op(const std::vector<BagSpecRecord>& records, char op) {
  std::vector<BagSpecRecord> found;
  for (const BagSpecRecord& record : records) {
    if (record.op() == op) found.push_back(record);
  }
  return found;
}

struct BagMessage {
  std::uint32_t channel;
  std::int64_t received_ns;
  std::size_t bytes;
};

std::string bag_of(const std::vector<BagMessage>& messages, ChunkPacking packing = ChunkPacking::kNone) {
  const TemporaryFolder folder;
  AtomicFileSet files;
  Ros1BagWriter writer(files.add(folder / "a.bag"), packing);
  EXPECT_EQ(writer.add_channel("/a", RosType::kInt32, false), 0U);
  EXPECT_EQ(writer.add_channel("/b", RosType::kTransforms, true), 1U);
  for (const BagMessage& one : messages) {
    writer.add(one.channel, one.received_ns, std::string(one.bytes, static_cast<char>('p' + one.channel)));
  }
  writer.finish();
  files.commit();
  std::string bytes = get_file(folder / "a.bag");
  EXPECT_EQ(writer.bytes(), bytes.size());
  EXPECT_EQ(bytes.substr(0, kBagMagicBytes), "#ROSBAG V2.0\n");
  return bytes;
}

constexpr std::int64_t kSecond_ns = 1'000'000'000;
const std::vector<BagMessage> kTwoChunks{{0, 5 * kSecond_ns + 7, 3},
                                         {1, 4 * kSecond_ns + 999'999'999, kBagChunkLimit},
                                         {0, 9 * kSecond_ns, 5},
                                         {0, 8 * kSecond_ns + 1, 6}};

/// Made once: it has most of a megabyte.
const std::string& two_chunks() {
  static const std::string bytes = bag_of(kTwoChunks);
  return bytes;
}

TEST(WrittenBag, TheFirstRecordSaysWhereTheIndexIs) {
  const std::string& bytes = two_chunks();
  const std::vector<BagSpecRecord> records = bag_spec_records(bytes, kBagMagicBytes);
  std::string ops;
  for (const BagSpecRecord& record : records) ops += record.op();
  EXPECT_EQ(ops, "\3\5\4\4\5\4\7\7\6\6") << "chunks with their indexes, connections, what the index tells of chunks";
  EXPECT_EQ(records[0].end - records[0].begin, 4096U);
  EXPECT_EQ(records[0].data, std::string(records[0].data.size(), ' '));
  EXPECT_EQ(records[0].whole("index_pos"), of_op(records, '\7').at(0).begin);
  EXPECT_EQ(records[0].whole("conn_count"), 2U);
  EXPECT_EQ(records[0].whole("chunk_count"), 2U);
}

TEST(WrittenBag, ChunksAreToldWithTheirTimesAndCounts) {
  const std::string& bytes = two_chunks();
  const std::vector<BagSpecRecord> records = bag_spec_records(bytes, kBagMagicBytes);
  const auto chunks = of_op(records, '\5');
  const auto infos = of_op(records, '\6');
  ASSERT_EQ(chunks.size(), 2U);
  ASSERT_EQ(infos.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(infos[k].whole("ver"), 1U);
    EXPECT_EQ(infos[k].whole("chunk_pos"), chunks[k].begin);
    EXPECT_EQ(chunks[k].whole("size"), chunks[k].data.size());
    EXPECT_EQ(chunks[k].fields.at("compression"), "none");
  }
  using test::raw;
  EXPECT_EQ(infos[0].fields.at("start_time"), raw(4U) + raw(999'999'999U));
  EXPECT_EQ(infos[0].fields.at("end_time"), raw(5U) + raw(7U));
  EXPECT_EQ(infos[0].data, raw(0U) + raw(1U) + raw(1U) + raw(1U)) << "one message of each connection";
  EXPECT_EQ(infos[0].whole("count"), 2U);
  EXPECT_EQ(infos[1].fields.at("start_time"), raw(8U) + raw(1U));
  EXPECT_EQ(infos[1].fields.at("end_time"), raw(9U) + raw(0U));
  EXPECT_EQ(infos[1].data, raw(0U) + raw(2U));
  EXPECT_EQ(infos[1].whole("count"), 1U);
}

TEST(WrittenBag, AnIndexFindsItsMessages) {
  const std::string& bytes = two_chunks();
  std::vector<std::array<std::uint64_t, 3>> found;  // connection, seconds, length
  std::string chunk;
  for (const BagSpecRecord& record : bag_spec_records(bytes, kBagMagicBytes)) {
    if (record.op() == '\5') chunk = record.data;
    if (record.op() != '\4') continue;
    EXPECT_EQ(record.whole("ver"), 1U);
    ASSERT_EQ(record.data.size(), 12 * record.whole("count"));
    for (std::size_t at = 0; at < record.data.size(); at += 12) {
      const BagSpecRecord message = bag_spec_records(chunk, whole_of(record.data.substr(at + 8, 4))).at(0);
      EXPECT_EQ(message.op(), '\2');
      EXPECT_EQ(message.fields.at("conn"), record.fields.at("conn"));
      EXPECT_EQ(message.fields.at("time"), record.data.substr(at, 8));
      found.push_back({message.whole("conn"), whole_of(record.data.substr(at, 4)), message.data.size()});
    }
  }
  using Row = std::array<std::uint64_t, 3>;
  EXPECT_THAT(found, ElementsAre(Row{0, 5, 3}, Row{1, 4, kBagChunkLimit}, Row{0, 9, 5}, Row{0, 8, 6}));
}

TEST(WrittenBag, ConnectionsStandInTheFirstChunkAndInTheIndex) {
  const std::string& bytes = two_chunks();
  const std::vector<BagSpecRecord> records = bag_spec_records(bytes, kBagMagicBytes);
  const auto indexed = of_op(records, '\7');
  const auto first = of_op(bag_spec_records(of_op(records, '\5').at(0).data, 0), '\7');
  ASSERT_EQ(indexed.size(), 2U);
  ASSERT_EQ(first.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(first[k].fields, indexed[k].fields);
    EXPECT_EQ(first[k].data, indexed[k].data);
    EXPECT_EQ(indexed[k].whole("conn"), k);
    const auto about = bag_spec_fields(indexed[k].data);
    EXPECT_EQ(about.at("topic"), indexed[k].fields.at("topic"));
    EXPECT_EQ(about.at("type"), k == 0 ? "std_msgs/Int32" : "tf2_msgs/TFMessage");
    EXPECT_EQ(about.at("md5sum"), ros_md5(k == 0 ? RosType::kInt32 : RosType::kTransforms));
    EXPECT_EQ(about.count("latching"), k) << "only of the latched";
    EXPECT_EQ(about.count("callerid"), k);
  }
  EXPECT_EQ(bag_spec_fields(indexed[1].data).at("latching"), "1");
}

TEST(WrittenBag, AChunkEndsWithWhatFills768KiB) {
  // A message has its two lengths and the fields op (5), conn (9) and time (13), each with its length, around its data.
  constexpr std::size_t kHead = 4 + (4 + 4) + (4 + 9) + (4 + 13) + 4;
  const auto chunks_with = [](std::size_t bytes) {
    const std::string file = bag_of({{0, 1, kBagChunkLimit}, {0, 2, bytes - kHead}, {0, 3, 0}}, ChunkPacking::kLz4);
    return of_op(bag_spec_records(file, kBagMagicBytes), '\5').size();
  };
  EXPECT_EQ(chunks_with(kBagChunkLimit), 3U);
  EXPECT_EQ(chunks_with(kBagChunkLimit - 1), 2U);
}

TEST(WrittenBag, WithoutAMessageThereAreItsConnections) {
  const std::vector<BagSpecRecord> records = bag_spec_records(bag_of({}), kBagMagicBytes);
  std::string ops;
  for (const BagSpecRecord& record : records) ops += record.op();
  EXPECT_EQ(ops, "\3\5\7\7\6");
}

// Noise cannot be packed: bzip2 needs room for more than it got.
TEST(ChunkPacking, NoiseAndZerosComeBack) {
  Random random(3);
  std::string noise(300'000, '\0');
  for (char& byte : noise) byte = static_cast<char>(random.below(256));
  for (const ChunkPacking packing :
       {ChunkPacking::kNone, ChunkPacking::kLz4, ChunkPacking::kBz2, ChunkPacking::kZstd}) {
    for (const std::string& bytes : {noise, std::string(300'000, '\0'), std::string("a"), std::string()}) {
      const std::string packed = packed_chunk(bytes, packing);
      const auto source = unpacked_chunk(open_memory_source(bytes_of(packed)), packing_name(packing), "any");
      EXPECT_TRUE(read_all(*source, 1'000'000, "it", "") == bytes) << packing_name(packing) << ' ' << bytes.size();
    }
  }
}

// The descriptor of an lz4 frame: version 1, independent blocks (bit 5), a checksum of the content (bit 2).
TEST(ChunkPacking, AnLz4FrameHasIndependentBlocksAndASum) {
  const std::string packed = packed_chunk("text", ChunkPacking::kLz4);
  ASSERT_GT(packed.size(), 5U);
  EXPECT_EQ(packed.substr(0, 4), "\x04\x22\x4d\x18");
  EXPECT_EQ(static_cast<unsigned char>(packed[4]) & 0xe4U, 0x64U);
}

// The largest blocks, of 900 kB, are the sign '9' of the head.
TEST(ChunkPacking, BzipHasTheLargestBlocks) {
  EXPECT_EQ(packed_chunk("text", ChunkPacking::kBz2).substr(0, 4), "BZh9");
}

}  // namespace
}  // namespace gdtslam

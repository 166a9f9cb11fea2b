// What an MCAP file says of itself, by its specification (https://mcap.dev/spec): lengths, sums, indexes, statistics.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "engine/io/recordings/containers/chunk.hpp"
#include "engine/io/sha256.hpp"
#include "engine/io/writers/mcap_writer.hpp"
#include "gdtslam/core/random.hpp"
#include "io_test_support.hpp"
#include "mcap_writer.hpp"

namespace gdtslam {
namespace {

/// Little endian fields, one after the other.
class McapSpecFields {
 public:
  explicit McapSpecFields(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t whole(std::size_t size) {
    std::uint64_t value = 0;
    const std::string_view taken = take(size);
    for (std::size_t k = 0; k < taken.size(); ++k) {
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(taken[k])) << (8U * k);
    }
    return value;
  }
  std::string_view take(std::size_t size) {
    EXPECT_LE(at_ + size, bytes_.size());
    const std::string_view taken = bytes_.substr(std::min(at_, bytes_.size()), size);
    at_ += size;
    return taken;
  }
  std::string_view text() { return take(whole(4)); }
  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] bool at_end() const { return at_ >= bytes_.size(); }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

struct McapSpecRecord {
  char opcode = 0;
  std::size_t begin = 0;  ///< its opcode
  std::size_t end = 0;
  std::string_view content{};
};

/// Of a file between its two magics, or of a chunk.
std::vector<McapSpecRecord> mcap_spec_records(std::string_view bytes, std::size_t begin, std::size_t end) {
  std::vector<McapSpecRecord> records;
  while (begin + 9 <= end) {
    McapSpecFields head(bytes.substr(begin + 1));
    const std::size_t size = head.whole(8);
    records.push_back({bytes[begin], begin, begin + 9 + size, bytes.substr(begin + 9, size)});
    begin = records.back().end;
  }
  EXPECT_EQ(begin, end);
  return records;
}

std::vector<McapSpecRecord> of_opcode(const std::vector<McapSpecRecord>& records, char opcode) {
  std::vector<McapSpecRecord> found;
  for (const McapSpecRecord& record : records) {
    if (record.opcode == opcode) found.push_back(record);
  }
  return found;
}

std::string opcodes_of(const std::vector<McapSpecRecord>& records) {
  std::string opcodes;
  for (const McapSpecRecord& record : records) opcodes += record.opcode;
  return opcodes;
}

constexpr std::size_t kMagicBytes = 8;
constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;
constexpr std::size_t kMessageHead = 9 + 2 + 4 + 8 + 8;  // opcode, length, channel, sequence, two times

struct SentMessage {
  std::uint32_t channel;
  std::int64_t received_ns;
  std::size_t bytes;
};

/// Two channels of one type and one of another; the messages are of letters.
std::string mcap_of(const std::vector<SentMessage>& messages, ChunkPacking packing) {
  const TemporaryFolder folder;
  AtomicFileSet files;
  McapWriter writer(files.add(folder / "a.mcap"), packing);
  EXPECT_EQ(writer.add_channel("/a", RosType::kInt32, false), 0U);
  EXPECT_EQ(writer.add_channel("/b", RosType::kTransforms, true), 1U);
  EXPECT_EQ(writer.add_channel("/c", RosType::kInt32, false), 2U);
  for (const SentMessage& one : messages) {
    writer.add(one.channel, one.received_ns, std::string(one.bytes, static_cast<char>('p' + one.channel)));
  }
  writer.finish();
  files.commit();
  std::string bytes = get_file(folder / "a.mcap");
  EXPECT_EQ(writer.bytes(), bytes.size());
  return bytes;
}

std::vector<McapSpecRecord> records_of_file(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, kMagicBytes), test::kMcapStart);
  EXPECT_EQ(bytes.substr(bytes.size() - kMagicBytes), test::kMcapStart);
  return mcap_spec_records(bytes, kMagicBytes, bytes.size() - kMagicBytes);
}

const std::vector<SentMessage> kThreeChunks{{0, 50, 3}, {1, 40, kChunkBytes}, {0, 70, 5},
                                            {0, 60, 6}, {2, 80, kChunkBytes}, {2, 30, 7}};

/// Made once: it has two megabytes.
const std::string& three_chunks() {
  static const std::string bytes = mcap_of(kThreeChunks, ChunkPacking::kNone);
  return bytes;
}

TEST(WrittenMcap, ChunksAreFollowedByTheirIndexesAndTheSummary) {
  const std::string& bytes = three_chunks();
  // Header, chunks with an index for each channel in them, the end of the data, schemas, channels, statistics, indexes
  // of chunks, where these groups are, footer.
  EXPECT_EQ(opcodes_of(records_of_file(bytes)), "\1\6\7\7\6\7\7\6\7\17\3\3\4\4\4\13\10\10\10\16\16\16\16\2");
}

// Channels, schemas, sums, statistics and indexes, as they were compared with the specification field by field.
TEST(WrittenMcap, EveryByteIsThatOfTheSpecification) {
  const auto sha256 = [](const std::string& bytes) { return Sha256().update(std::string_view(bytes)).hex(); };
  EXPECT_EQ(sha256(three_chunks()), "83ff7384fa076e8169074d35baf27b6ba2be862187339fc28ff86ddbc66b430d");
  EXPECT_EQ(sha256(mcap_of({}, ChunkPacking::kNone)),
            "d5a4efcd8b07a752a4c2f3f5b231fe832a5df14763de95a87ee287ebd3dad6e1");
  std::string definitions;
  for (const RosType type : {RosType::kLaserScan, RosType::kOdometry, RosType::kTransforms, RosType::kInt32,
                             RosType::kJointState, RosType::kPoseStamped, RosType::kOccupancyGrid}) {
    definitions += ros_type_name(type) + "\n" + ros_definition(type);
  }
  EXPECT_EQ(sha256(definitions), "6bc16d1a9f4915564ed8ccd6efa3ab8254f762869c656c2af1d1f9a21bcb8808")
      << "once compared with the published MD5 sums of the types";
}

void expect_chunk_index(const McapSpecRecord& index, const std::vector<McapSpecRecord>& records, std::size_t chunk,
                        std::string_view packing) {
  McapSpecFields fields(index.content);
  McapSpecFields stated(records[chunk].content);
  EXPECT_EQ(fields.whole(8), stated.whole(8));  // times of the first message
  EXPECT_EQ(fields.whole(8), stated.whole(8));  // and of the last
  EXPECT_EQ(fields.whole(8), records[chunk].begin);
  EXPECT_EQ(fields.whole(8), records[chunk].end - records[chunk].begin);
  McapSpecFields places(fields.text());
  std::size_t at = chunk + 1;
  for (; records[at].opcode == '\7'; ++at) {
    EXPECT_EQ(places.whole(2), McapSpecFields(records[at].content).whole(2));
    EXPECT_EQ(places.whole(8), records[at].begin);
  }
  EXPECT_TRUE(places.at_end());
  EXPECT_EQ(fields.whole(8), records[at - 1].end - records[chunk].end) << "all indexes behind the chunk";
  EXPECT_EQ(fields.text(), packing);
  const std::uint64_t unpacked_bytes = stated.whole(8);
  (void)stated.whole(4);
  EXPECT_EQ(stated.text(), packing);
  EXPECT_EQ(fields.whole(8), stated.whole(8));
  EXPECT_EQ(fields.whole(8), unpacked_bytes);
  EXPECT_TRUE(fields.at_end());
}

TEST(WrittenMcap, TheIndexOfChunksSaysWhereEachIs) {
  for (const auto& [packing, name] :
       {std::pair(ChunkPacking::kNone, ""), {ChunkPacking::kLz4, "lz4"}, {ChunkPacking::kZstd, "zstd"}}) {
    const std::string bytes = mcap_of(kThreeChunks, packing);
    const std::vector<McapSpecRecord> records = records_of_file(bytes);
    const auto indexes = of_opcode(records, '\10');
    ASSERT_EQ(indexes.size(), 3U);
    std::size_t chunk = 0;
    for (const McapSpecRecord& index : indexes) {
      while (records[chunk].opcode != '\6') ++chunk;
      expect_chunk_index(index, records, chunk++, name);
    }
  }
}

TEST(WrittenMcap, AChunkEndsWithWhatFillsOneMebibyte) {
  // The first chunk has the channels, too; the second has messages alone.
  const auto chunks_with = [](std::size_t bytes) {
    const std::string file =
        mcap_of({{0, 1, kChunkBytes}, {0, 2, bytes - kMessageHead}, {0, 3, 0}}, ChunkPacking::kZstd);
    return of_opcode(records_of_file(file), '\6').size();
  };
  EXPECT_EQ(chunks_with(kChunkBytes), 3U);
  EXPECT_EQ(chunks_with(kChunkBytes - 1), 2U);
}

// Noise cannot be packed: it becomes longer.
TEST(ChunkPacking, NoiseAndZerosComeBack) {
  Random random(3);
  std::string noise(300'000, '\0');
  for (char& byte : noise) byte = static_cast<char>(random.below(256));
  for (const ChunkPacking packing : {ChunkPacking::kNone, ChunkPacking::kLz4, ChunkPacking::kZstd}) {
    for (const std::string& bytes : {noise, std::string(300'000, '\0'), std::string("a"), std::string()}) {
      const std::string packed = packed_chunk(bytes, packing);
      const auto source = unpacked_chunk(open_memory_source(bytes_of(packed)), packing_name(packing), "any");
      EXPECT_TRUE(read_all(*source, 1'000'000, "it", "") == bytes) << packing_name(packing) << ' ' << bytes.size();
    }
  }
}

}  // namespace
}  // namespace gdtslam

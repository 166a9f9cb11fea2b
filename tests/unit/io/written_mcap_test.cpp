// The bytes of an MCAP file, as they were compared with its specification (https://mcap.dev/spec), and packed chunks.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/io/recordings/containers/chunk.hpp"
#include "engine/io/sha256.hpp"
#include "engine/io/writers/mcap_writer.hpp"
#include "gdtslam/core/random.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;

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

const std::vector<SentMessage> kThreeChunks{{0, 50, 3}, {1, 40, kChunkBytes}, {0, 70, 5},
                                            {0, 60, 6}, {2, 80, kChunkBytes}, {2, 30, 7}};

/// Made once: it has two megabytes.
const std::string& three_chunks() {
  static const std::string bytes = mcap_of(kThreeChunks, ChunkPacking::kNone);
  return bytes;
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

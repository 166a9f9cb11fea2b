// Packed streams: whole, one after the other, cut, with something behind them; and what is read of a source at all.
#include "engine/io/unpack_source.hpp"

#include <bzlib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kPackedText = "log\n";

std::string as_bzip2(std::string text) {
  auto size = static_cast<unsigned>(2 * text.size() + 600);
  std::string packed(size, '\0');
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &size, text.data(), static_cast<unsigned>(text.size()), 1, 0, 0),
            BZ_OK);
  packed.resize(size);
  return packed;
}

std::string as_zstd(const std::string& text) {
  std::string packed(ZSTD_compressBound(text.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 1));
  return packed;
}

/// The text by `xz --check=crc32`.
std::string text_in_xz() {
  constexpr std::array<unsigned char, 56> kBytes{
      0xfd, 0x37, 0x7a, 0x58, 0x5a, 0x00, 0x00, 0x01, 0x69, 0x22, 0xde, 0x36, 0x02, 0x00, 0x21, 0x01, 0x16, 0x00, 0x00,
      0x00, 0x74, 0x2f, 0xe5, 0xa3, 0x01, 0x00, 0x03, 0x6c, 0x6f, 0x67, 0x0a, 0x00, 0xc4, 0x0f, 0x56, 0xd9, 0x00, 0x01,
      0x18, 0x04, 0x6b, 0xe9, 0xf0, 0xa5, 0x90, 0x42, 0x99, 0x0d, 0x01, 0x00, 0x00, 0x00, 0x00, 0x01, 0x59, 0x5a};
  return {reinterpret_cast<const char*>(kBytes.data()), kBytes.size()};
}

/// What comes out in pieces of so many bytes, and what is said of the end.
struct Unpacked {
  std::string text{};
  std::string defect{};
  double progress = 0.0;
  std::uint64_t from_file = 0;
};
Unpacked drained(ByteSource& source, std::size_t piece_bytes) {
  Unpacked unpacked;
  std::string piece(piece_bytes, '\0');
  for (std::size_t count = 0; (count = source.read(piece)) > 0;) unpacked.text.append(piece, 0, count);
  EXPECT_EQ(source.read(piece), 0U) << "the end stays the end";
  unpacked.defect = source.defect();
  unpacked.progress = source.progress();
  unpacked.from_file = source.bytes_from_file();
  return unpacked;
}

struct PackedKind {
  std::string name;
  std::string packed;
  [[nodiscard]] std::unique_ptr<ByteSource> open(const std::string& bytes) const {
    auto memory = open_memory_source(bytes_of(bytes));
    if (name == "gzip") return gunzip_if_packed(std::move(memory), "p");
    const StreamPacking packing = name == "bzip2" ? StreamPacking::kBzip2
                                  : name == "xz"  ? StreamPacking::kXz
                                                  : StreamPacking::kZstd;
    return unpack_source(packing, std::move(memory), "p");
  }
  [[nodiscard]] Unpacked unpacked(const std::string& bytes, std::size_t piece_bytes = 100) const {
    return drained(*open(bytes), piece_bytes);
  }
};

std::vector<PackedKind> packed_kinds() {
  return {{"gzip", gzip(kPackedText)},
          {"bzip2", as_bzip2(kPackedText)},
          {"xz", text_in_xz()},
          {"zstd", as_zstd(kPackedText)}};
}

TEST(UnpackSource, StreamsFollowEachOtherInPiecesOfAnySize) {
  for (const PackedKind& kind : packed_kinds()) {
    for (const std::size_t piece_bytes : {1U, 4U, 5U, 100U}) {
      const Unpacked once = kind.unpacked(kind.packed, piece_bytes);
      EXPECT_EQ(once.text, kPackedText) << kind.name << ' ' << piece_bytes;
      EXPECT_EQ(once.defect, "") << kind.name << ' ' << piece_bytes;
      const Unpacked thrice = kind.unpacked(kind.packed + kind.packed + kind.packed, piece_bytes);
      EXPECT_EQ(thrice.text, kPackedText + kPackedText + kPackedText) << kind.name << ' ' << piece_bytes;
      EXPECT_EQ(thrice.defect, "") << kind.name << ' ' << piece_bytes;
      EXPECT_EQ(thrice.progress, 1.0);
      EXPECT_EQ(thrice.from_file, 3 * kind.packed.size());
    }
  }
}

TEST(UnpackSource, ACutStreamIsToldAndGivesABeginning) {
  for (const PackedKind& kind : packed_kinds()) {
    for (std::size_t size = 2; size < kind.packed.size(); ++size) {
      const Unpacked cut = kind.unpacked(kind.packed.substr(0, size));
      EXPECT_TRUE(kPackedText.starts_with(cut.text)) << kind.name << ' ' << size;
      EXPECT_EQ(cut.defect, "the " + kind.name + " stream stops early") << size;
      EXPECT_EQ(kind.unpacked(kind.packed + kind.packed.substr(0, size)).defect,
                "the " + kind.name + " stream stops early")
          << "the second one";
    }
  }
}

TEST(UnpackSource, WhatStandsBehindIsIgnoredOrDamage) {
  for (const PackedKind& kind : packed_kinds()) {
    const std::string followed = kind.packed + "rest";
    if (kind.name == "zstd") {
      EXPECT_THAT(told_by<InputError>([&] { (void)kind.unpacked(followed); }),
                  AllOf(HasSubstr("p: damaged zstd data"), HasSubstr("unpack it with zstd -dc")));
      continue;
    }
    const Unpacked unpacked = kind.unpacked(followed);
    EXPECT_EQ(unpacked.text, kPackedText);
    EXPECT_EQ(unpacked.defect, "bytes after the " + kind.name + " stream are ignored");
  }
}

TEST(UnpackSource, AWrongSumIsDamage) {
  for (const PackedKind& kind : packed_kinds()) {
    if (kind.name == "zstd") continue;  // it was packed without one
    // The sum of the content: of gzip before its length, of bzip2 in the head of the block, of xz behind the block.
    std::string wrong = kind.packed;
    const std::size_t at = kind.name == "gzip" ? wrong.size() - 8 : kind.name == "bzip2" ? 10 : 32;
    wrong[at] = static_cast<char>(wrong[at] ^ 1);
    EXPECT_THAT(
        told_by<InputError>([&] { (void)kind.unpacked(wrong); }),
        AllOf(StartsWith("p: damaged " + kind.name + " data"), HasSubstr("unpack it with " + kind.name + " -dc")));
  }
}

// More than a piece of packed bytes, and what a piece of them unpacks to is more than the target holds.
TEST(UnpackSource, NoiseAndZerosOfAnyLengthComeBack) {
  Random random(5);
  std::string text(200'000, '\0');
  for (char& byte : text) byte = static_cast<char>(random.below(256));
  text.append(200'000, '\0');
  for (const PackedKind& kind :
       {PackedKind{"gzip", gzip(text)}, PackedKind{"bzip2", as_bzip2(text)}, PackedKind{"zstd", as_zstd(text)}}) {
    for (const std::size_t piece_bytes : {1000U, 65536U, 500'000U}) {
      const Unpacked unpacked = kind.unpacked(kind.packed, piece_bytes);
      EXPECT_TRUE(unpacked.text == text) << kind.name << ' ' << piece_bytes;
      EXPECT_EQ(unpacked.defect, "");
    }
  }
}

TEST(GunzipIfPacked, WhatDoesNotBeginWithBothBytesIsPlain) {
  for (const std::string text : {"", "\x1f", "\x8b", "\x1fx", "x\x8b", "\x1f\x8c rest", "\x1e\x8b rest", "plain"}) {
    const auto source = gunzip_if_packed(open_memory_source(bytes_of(text)), "p");
    const Unpacked plain = drained(*source, 1);
    EXPECT_EQ(plain.text, text);
    EXPECT_EQ(plain.defect, "");
    EXPECT_EQ(plain.from_file, text.size());
  }
}

TEST(ByteSource, ProgressIsTheShareOfWhatHasALength) {
  const TemporaryFolder folder;
  put_file(folder / "ten", "0123456789");
  const auto file = open_file_source(folder / "ten");
  std::array<char, 4> four{};
  EXPECT_EQ(file->progress(), 0.0);
  EXPECT_EQ(file->read(four), 4U);
  EXPECT_EQ(file->progress(), 0.4);
  EXPECT_EQ(file->bytes_from_file(), 4U);
  std::ofstream(folder / "ten", std::ios::app) << "0123456789";  // what grows while it is read
  EXPECT_EQ(drained(*file, 4).progress, 1.0);
  EXPECT_EQ(open_file_source("/dev/null")->progress(), -1.0);
  const auto memory = open_memory_source(bytes_of("01234567"));
  EXPECT_EQ(memory->read(four), 4U);
  EXPECT_EQ(memory->progress(), 0.5);
  EXPECT_EQ(open_memory_source({})->progress(), 1.0);
  EXPECT_EQ(drained(*with_head("ab", open_memory_source(bytes_of("cd"))), 1).text, "abcd");
  EXPECT_EQ(drained(*with_head("", open_memory_source(bytes_of("cd"))), 9).text, "cd");
}

}  // namespace
}  // namespace gdtslam

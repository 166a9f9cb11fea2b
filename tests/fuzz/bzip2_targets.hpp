// Streams of bzip2 whose checksums are made right, so that what a fuzzer changes in their blocks gets as far as the
// tables and the transform behind them.
#pragma once

#include <bzlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/unpack_source.hpp"
#include "packed_targets.hpp"
#include "target.hpp"

namespace gdtslam::fuzz {
namespace detail {

/// CRC-32 from the most significant bit on, as bzip2 has it of the bytes of a block.
inline std::uint32_t bzip2_crc(std::string_view plain) {
  static const std::array<std::uint32_t, 256> table = [] {
    constexpr std::uint32_t kPolynomial = 0x04c11db7U;
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t byte = 0; byte < made.size(); ++byte) {
      std::uint32_t rest = byte << 24U;
      for (int bit = 0; bit < 8; ++bit) rest = (rest << 1U) ^ ((rest >> 31U) != 0U ? kPolynomial : 0U);
      made[byte] = rest;
    }
    return made;
  }();
  std::uint32_t crc = ~0U;
  for (const char c : plain) crc = (crc << 8U) ^ table[(crc >> 24U) ^ static_cast<unsigned char>(c)];
  return ~crc;
}

/// Where 48 bits begin that stand before a checksum: they need not begin a byte.
inline std::vector<std::size_t> places_of_bits(std::string_view stream, std::uint64_t wanted) {
  constexpr std::size_t kBits = 48;
  constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
  std::vector<std::size_t> places;
  std::uint64_t window = 0;
  for (std::size_t bit = 0; bit < 8 * stream.size(); ++bit) {
    window = (window << 1U | (static_cast<unsigned char>(stream[bit / 8]) >> (7 - bit % 8) & 1U)) & kMask;
    if (window == wanted && bit + 1 >= kBits) places.push_back(bit + 1 - kBits);
  }
  return places;
}

/// The checksum behind 48 bits.
inline void put_checksum(std::string& stream, std::size_t place, std::uint32_t checksum) {
  for (std::size_t k = 0; k < 32; ++k) {
    const std::size_t bit = place + 48 + k;
    if (bit / 8 >= stream.size()) return;
    const auto mask = static_cast<unsigned char>(1U << (7 - bit % 8));
    const auto byte = static_cast<unsigned char>(stream[bit / 8]);
    stream[bit / 8] = static_cast<char>((checksum >> (31 - k) & 1U) != 0U ? byte | mask : byte & ~mask);
  }
}

/// What the library makes of the stream, up to a fault, a wrong checksum being one behind the block that it is of.
struct Bunzipped {
  std::string bytes;
  bool is_whole = false;
};
inline Bunzipped bunzipped(std::string stream) {
  Bunzipped out{std::string(kMostUnpacked, '\0'), false};
  bz_stream state{};
  require(BZ2_bzDecompressInit(&state, 0, 0) == BZ_OK);
  state.next_in = stream.data();
  state.avail_in = static_cast<unsigned>(stream.size());
  state.next_out = out.bytes.data();
  state.avail_out = static_cast<unsigned>(out.bytes.size());
  out.is_whole = BZ2_bzDecompress(&state) == BZ_STREAM_END;
  out.bytes.resize(out.bytes.size() - state.avail_out);
  BZ2_bzDecompressEnd(&state);
  return out;
}

inline std::string with_bzip2_checksums(std::string stream) {
  constexpr std::uint64_t kBlock = 0x314159265359U;  // pi
  constexpr std::uint64_t kEnd = 0x177245385090U;    // its root
  constexpr std::size_t kMostBlocks = 8;
  std::size_t known = 0;
  std::uint32_t combined = 0;
  const std::vector<std::size_t> blocks = places_of_bits(stream, kBlock);
  for (std::size_t k = 0; k < std::min(blocks.size(), kMostBlocks); ++k) {
    const std::string bytes = bunzipped(stream).bytes;  // those of this block come out before its checksum is compared
    if (bytes.size() < known) break;
    const std::uint32_t checksum = bzip2_crc(std::string_view(bytes).substr(known));
    put_checksum(stream, blocks[k], checksum);
    combined = std::rotl(combined, 1) ^ checksum;
    known = bytes.size();
  }
  for (const std::size_t end : places_of_bits(stream, kEnd)) put_checksum(stream, end, combined);
  return stream;
}

}  // namespace detail

/// The first byte says how much is asked for at a time. What the library unpacks in one go comes out.
inline void read_bzip2_blocks(std::span<const std::byte> data) {
  if (data.size() < 2) return;
  const auto piece = std::to_integer<std::size_t>(data[0]);
  const std::string stream = detail::with_bzip2_checksums(std::string(text_of(data.subspan(1))));
  const detail::Unpacked out = detail::unpacked(StreamPacking::kBzip2, stream, piece);
  const detail::Bunzipped all = detail::bunzipped(stream);
  if (!all.is_whole) return;
  require(out.bytes.starts_with(all.bytes), "a stream of bzip2 comes out as other bytes");
}

inline constexpr std::array kBzip2Targets{FuzzTarget{"bzip2_blocks", read_bzip2_blocks, 4}};

}  // namespace gdtslam::fuzz

// What unpacks gzip, bzip2, xz and zstd. Checksums stop a fuzzer, so the first byte says whether the rest is packed
// data as they are, with gzip's checksum made right, or plain bytes that are packed here and have to come out again.
#pragma once

#include <bzlib.h>
#include <lzma.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "engine/io/byte_source.hpp"
#include "engine/io/little_endian.hpp"
#include "engine/io/unpack_source.hpp"
#include "target.hpp"

namespace gdtslam::fuzz {
namespace detail {

inline constexpr std::size_t kMostUnpacked = std::size_t{1} << 20U;  // of what a bomb unpacks to

/// "\x1f\x8b" tells gzip, which has no name here.
using Packing = std::optional<StreamPacking>;

inline std::unique_ptr<ByteSource> unpacking(Packing packing, std::string_view packed) {
  std::unique_ptr<ByteSource> source = open_memory_source(bytes_of(packed));
  return packing ? unpack_source(*packing, std::move(source), "fuzz") : gunzip_if_packed(std::move(source), "fuzz");
}

/// What comes out, and whether the end of it was in order.
struct Unpacked {
  std::string bytes;
  bool is_whole = false;
};
inline Unpacked unpacked(Packing packing, std::string_view packed, std::size_t piece) {
  Unpacked out;
  expect_typed<InputError>([&] {
    const std::unique_ptr<ByteSource> source = unpacking(packing, packed);
    std::string target(std::max<std::size_t>(piece, 1), '\0');
    while (out.bytes.size() < kMostUnpacked) {
      const std::size_t count = source->read(target);
      require(count <= target.size());
      if (count == 0) {
        out.is_whole = source->defect().empty();
        require(is_one_line(source->defect().c_str()));
        return;
      }
      out.bytes.append(target.data(), count);
    }
  });
  return out;
}

inline std::string gzip_of(std::string_view plain) {
  constexpr int kGzip = 16 + MAX_WBITS;
  constexpr int kMemory = 8;
  z_stream stream{};
  require(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string packed(deflateBound(&stream, static_cast<uLong>(plain.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
  stream.avail_in = static_cast<uInt>(plain.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  require(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

inline std::string packed(Packing packing, std::string_view plain) {
  if (!packing) return gzip_of(plain);
  std::string out(2 * plain.size() + 1024, '\0');
  if (*packing == StreamPacking::kBzip2) {
    auto size = static_cast<unsigned>(out.size());
    require(BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(plain.data()),
                                     static_cast<unsigned>(plain.size()), 1, 0, 0) == BZ_OK);
    out.resize(size);
  } else if (*packing == StreamPacking::kXz) {
    std::size_t size = 0;
    require(lzma_easy_buffer_encode(0, LZMA_CHECK_CRC32, nullptr, reinterpret_cast<const std::uint8_t*>(plain.data()),
                                    plain.size(), reinterpret_cast<std::uint8_t*>(out.data()), &size,
                                    out.size()) == LZMA_OK);
    out.resize(size);
  } else {
    const std::size_t size = ZSTD_compress(out.data(), out.size(), plain.data(), plain.size(), 1);
    require(ZSTD_isError(size) == 0U);
    out.resize(size);
  }
  return out;
}

/// A gzip stream without a name of ten bytes before its data, with the checksum and length of what these unpack to.
inline std::string with_gzip_trailer(std::string_view stream) {
  constexpr std::size_t kHead = 10;
  constexpr std::size_t kTrailer = 8;
  if (stream.size() < kHead + kTrailer) return std::string(stream);
  z_stream state{};
  require(inflateInit2(&state, -MAX_WBITS) == Z_OK);
  std::string plain(kMostUnpacked, '\0');
  state.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stream.data() + kHead));
  state.avail_in = static_cast<uInt>(stream.size() - kHead);
  state.next_out = reinterpret_cast<Bytef*>(plain.data());
  state.avail_out = static_cast<uInt>(plain.size());
  const int status = inflate(&state, Z_FINISH);
  const std::size_t end = stream.size() - state.avail_in;
  plain.resize(state.total_out);
  inflateEnd(&state);
  if (status != Z_STREAM_END) return std::string(stream);
  const auto crc = static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(plain.data()), static_cast<uInt>(plain.size())));
  const std::string_view rest = stream.substr(std::min(end + kTrailer, stream.size()));
  std::string trailer;
  append_little_endian(trailer, crc);
  append_little_endian(trailer, static_cast<std::uint32_t>(plain.size()));
  return std::string("\x1f\x8b\x08\0\0\0\0\0\0\x03", kHead) + std::string(stream.substr(kHead, end - kHead)) + trailer +
         std::string(rest);
}

}  // namespace detail

/// Plain bytes come out as they went in, and of a stream that was cut a part of them, which is told.
inline void read_packed(std::span<const std::byte> data) {
  constexpr std::array<detail::Packing, 4> kPackings{detail::Packing(), StreamPacking::kBzip2, StreamPacking::kXz,
                                                     StreamPacking::kZstd};
  if (data.size() < 2) return;
  const auto kind = std::to_integer<std::size_t>(data[0]);
  const auto more = std::to_integer<std::size_t>(data[1]);
  const std::string_view rest = text_of(data.subspan(2));
  const detail::Packing packing = kPackings[kind % kPackings.size()];
  const bool is_plain = kind / kPackings.size() % 2 == 1;
  if (!is_plain) {
    // Each reads only what begins as its streams do; whoever opens a log sees to that.
    detail::unpacked(packing, rest, more);
    if (!packing) detail::unpacked(packing, detail::with_gzip_trailer(rest), more);
    return;
  }
  const std::string packed = detail::packed(packing, rest);
  const detail::Unpacked whole = detail::unpacked(packing, packed, more);
  require(whole.bytes == rest && whole.is_whole, "packed bytes come out as others");
  const std::size_t left = std::max<std::size_t>(packed.size() * more / 256, 2);  // so that gzip is told
  const detail::Unpacked cut = detail::unpacked(packing, std::string_view(packed).substr(0, left), more);
  require(rest.starts_with(cut.bytes) && !cut.is_whole, "a cut stream passes for a whole one");
}

inline constexpr std::array kPackedTargets{FuzzTarget{"packed", read_packed, 8}};

}  // namespace gdtslam::fuzz

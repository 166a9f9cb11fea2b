// Bytes from packed streams, in order and once. Several streams in sequence count as one; a cut stream gives its bytes
// and reports a defect. Memory is bounded by the format, at most 128 MiB, for any unpacked size. One source belongs to
// one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "byte_source.hpp"

namespace gdtslam {

enum class StreamPacking : std::uint8_t { kGzip, kBzip2, kXz, kZstd, kLz4 };
/// The first bytes of the streams, by packing.
inline constexpr std::string_view kGzipMagic = "\x1f\x8b";
inline constexpr std::string_view kBzip2Magic = "BZh";
inline constexpr std::string_view kXzMagic = "\xfd\x37zXZ";
inline constexpr std::string_view kZstdMagic = "\x28\xb5\x2f\xfd";

/// `packed` begins with the first byte of the stream; `name` is for messages. Reading throws InputError for damaged
/// data.
std::unique_ptr<ByteSource> unpack_source(StreamPacking packing, std::unique_ptr<ByteSource> packed, std::string name);

/// The kind of a warning about the end of a packed input.
inline std::string_view defect_kind(std::string_view defect) {
  return defect.find("gzip") != std::string_view::npos ? "gzip stream" : "packed stream";
}

}  // namespace gdtslam

#include "chunk.hpp"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "engine/io/message_text.hpp"
#include "engine/io/unpack_source.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// The bytes of a packed chunk, whose faults are those of the recording.
class PackedChunk final : public ByteSource {
 public:
  PackedChunk(StreamPacking packing, std::unique_ptr<ByteSource> packed)
      : unpacked_(unpack_source(packing, std::move(packed), "")) {}
  std::size_t read(std::span<char> target) override {
    std::size_t count = 0;
    try {
      count = unpacked_->read(target);
    } catch (const InputError&) {
      throw RecordingFault("has a chunk with damaged packed data");
    }
    if (count == 0 && !target.empty() && unpacked_->defect().ends_with("early")) {
      throw RecordingFault("has packed data that stop early");
    }
    return count;
  }
  [[nodiscard]] double progress() const override { return unpacked_->progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return unpacked_->bytes_from_file(); }

 private:
  std::unique_ptr<ByteSource> unpacked_;
};

}  // namespace

std::size_t ChunkBytes::read(std::span<char> target) {
  const std::uint64_t left = end_ - file_.offset();
  if (left > 0 && file_.at_end()) throw RecordingCut("ends in the middle of a chunk");
  return file_.read_some(target.first(static_cast<std::size_t>(std::min<std::uint64_t>(target.size(), left))));
}

std::string_view unpacked_message(std::string_view bytes, std::string& buffer) {
  constexpr std::size_t kMostUnpackedPerByte = std::size_t{1} << 17U;  // a block of zstd has at most 128 KiB
  if (!bytes.starts_with(kZstdMagic)) return bytes;
  const unsigned long long stated = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (stated > kMostMessageBytes || stated > kMostUnpackedPerByte * bytes.size()) {  // or not stated
    throw RecordingFault("has a packed message that is too long, or does not state its length");
  }
  buffer.resize(static_cast<std::size_t>(stated));
  const std::size_t size = ZSTD_decompress(buffer.data(), buffer.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0U || size != buffer.size()) throw RecordingFault("has a damaged packed message");
  return buffer;
}

std::unique_ptr<ByteSource> unpacked_chunk(std::unique_ptr<ByteSource> packed, std::string_view compression,
                                           std::string_view supported) {
  if (compression.empty() || compression == "none") return packed;
  if (compression == "bz2") return std::make_unique<PackedChunk>(StreamPacking::kBzip2, std::move(packed));
  if (compression == "lz4") return std::make_unique<PackedChunk>(StreamPacking::kLz4, std::move(packed));
  if (compression == "zstd") return std::make_unique<PackedChunk>(StreamPacking::kZstd, std::move(packed));
  throw RecordingFault(fmt::format("has a chunk packed as {}; {} are read", in_quotes(compression), supported));
}

}  // namespace gdtslam

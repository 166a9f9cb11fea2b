#include "chunk.hpp"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>

#include "engine/io/message_text.hpp"
#include "engine/io/unpack_source.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// The bytes of a packed chunk; its faults become faults of the recording.
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

bool CountedBytes::fill() {
  if (has_crc_) (void)crc();
  crc_begin_ = 0;
  begin_ = 0;
  if (end_ == buffer_.size() && end_ < kPieceBytes) buffer_.resize(2 * end_);
  end_ = source_->read(buffer_);
  return end_ > 0;
}

std::size_t CountedBytes::read_some(std::span<char> target) {
  if (target.empty() || at_end()) return 0;
  const std::size_t count = std::min(target.size(), end_ - begin_);
  std::memcpy(target.data(), buffer_.data() + begin_, count);
  consume(count);
  return count;
}

void CountedBytes::read(std::span<char> target) {
  while (!target.empty()) {
    const std::size_t count = read_some(target);
    if (count == 0) throw RecordingCut("ends in the middle of a record");
    target = target.subspan(count);
  }
}

void CountedBytes::read_into(std::string& text, std::uint64_t count, std::size_t limit, const char* what) {
  if (count > limit) throw RecordingFault(fmt::format("has {} of {} bytes; at most {} are read", what, count, limit));
  text.clear();
  while (text.size() < count) {
    if (at_end()) throw RecordingCut("ends in the middle of a record");
    const std::size_t step = std::min<std::size_t>(static_cast<std::size_t>(count) - text.size(), end_ - begin_);
    text.append(buffer_.data() + begin_, step);
    consume(step);
  }
}

std::string CountedBytes::read_text(std::uint64_t count, std::size_t limit, const char* what) {
  std::string text;
  read_into(text, count, limit, what);
  return text;
}

void CountedBytes::skip(std::uint64_t count) {
  while (count > 0) {
    if (at_end()) throw RecordingCut("ends in the middle of a record");
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(count, end_ - begin_));
    consume(step);
    count -= step;
  }
}

void CountedBytes::start_crc() {
  has_crc_ = true;
  crc_ = 0;
  crc_begin_ = begin_;
}

std::uint32_t CountedBytes::crc() {
  const auto* const fresh = reinterpret_cast<const Bytef*>(buffer_.data()) + crc_begin_;
  crc_ = static_cast<std::uint32_t>(crc32_z(crc_, fresh, begin_ - crc_begin_));
  crc_begin_ = begin_;
  return crc_;
}

}  // namespace gdtslam

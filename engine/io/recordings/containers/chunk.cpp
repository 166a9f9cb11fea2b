#include "chunk.hpp"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <new>
#include <utility>

#include "engine/io/message_text.hpp"
#include "engine/io/unpack_source.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kNoMemoryForLz4 = "ERROR_allocation_failed";  // codes are in its static library alone
constexpr std::size_t kPackedPiece = std::size_t{1} << 15U;

/// What all packed chunks share: a piece of packed bytes, and how far it was used.
class PackedChunk : public ByteSource {
 public:
  explicit PackedChunk(std::unique_ptr<ByteSource> packed) : packed_(std::move(packed)) {}
  std::size_t read(std::span<char> target) override {
    while (!is_over_ && !target.empty()) {
      // What filled its target may hold more that needs no further bytes.
      if (begin_ == end_ && !may_hold_more_) {
        begin_ = 0;
        end_ = packed_->read(piece_);
        if (end_ == 0) throw RecordingFault("has packed data that stop early");
      }
      const std::size_t count = unpack({piece_.data() + begin_, end_ - begin_}, target);
      may_hold_more_ = count == target.size();
      if (count > 0) return count;
    }
    return 0;
  }
  [[nodiscard]] double progress() const override { return packed_->progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return packed_->bytes_from_file(); }

 protected:
  /// Unpacks some bytes and calls used(), and over() at the end.
  virtual std::size_t unpack(std::span<char> packed, std::span<char> target) = 0;
  void used(std::size_t count) { begin_ += count; }
  void over() { is_over_ = true; }

 private:
  std::unique_ptr<ByteSource> packed_;
  std::array<char, kPackedPiece> piece_;  // no zeros, which would take longer than a short chunk
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool is_over_ = false;
  bool may_hold_more_ = false;
};

class Bzip2Chunk final : public PackedChunk {
 public:
  explicit Bzip2Chunk(std::unique_ptr<ByteSource> packed) : PackedChunk(std::move(packed)) {
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  Bzip2Chunk(const Bzip2Chunk&) = delete;
  Bzip2Chunk& operator=(const Bzip2Chunk&) = delete;
  ~Bzip2Chunk() override { BZ2_bzDecompressEnd(&stream_); }

 private:
  std::size_t unpack(std::span<char> packed, std::span<char> target) override {
    constexpr std::size_t kMost = std::size_t{1} << 30U;
    const auto room = static_cast<unsigned>(std::min(target.size(), kMost));
    stream_.next_in = packed.data();
    stream_.avail_in = static_cast<unsigned>(packed.size());
    stream_.next_out = target.data();
    stream_.avail_out = room;
    const int status = BZ2_bzDecompress(&stream_);
    if (status == BZ_MEM_ERROR) throw std::bad_alloc();
    if (status != BZ_OK && status != BZ_STREAM_END) throw RecordingFault("has a chunk with damaged bzip2 data");
    if (status == BZ_STREAM_END) over();
    used(packed.size() - stream_.avail_in);
    return room - stream_.avail_out;
  }
  bz_stream stream_{};
};

class Lz4Chunk final : public PackedChunk {
 public:
  explicit Lz4Chunk(std::unique_ptr<ByteSource> packed) : PackedChunk(std::move(packed)) {
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context_, LZ4F_VERSION)) != 0U) throw std::bad_alloc();
  }
  Lz4Chunk(const Lz4Chunk&) = delete;
  Lz4Chunk& operator=(const Lz4Chunk&) = delete;
  ~Lz4Chunk() override { LZ4F_freeDecompressionContext(context_); }

 private:
  std::size_t unpack(std::span<char> packed, std::span<char> target) override {
    std::size_t written = target.size();
    std::size_t taken = packed.size();
    const std::size_t status = LZ4F_decompress(context_, target.data(), &written, packed.data(), &taken, nullptr);
    if (LZ4F_isError(status) != 0U && LZ4F_getErrorName(status) == kNoMemoryForLz4) throw std::bad_alloc();
    if (LZ4F_isError(status) != 0U) throw RecordingFault("has a chunk with damaged lz4 data");
    if (status == 0) over();
    used(taken);
    return written;
  }
  LZ4F_dctx* context_ = nullptr;
};

class ZstdChunk final : public PackedChunk {
 public:
  explicit ZstdChunk(std::unique_ptr<ByteSource> packed)
      : PackedChunk(std::move(packed)), context_(ZSTD_createDCtx(), &ZSTD_freeDCtx) {
    if (context_ == nullptr) throw std::bad_alloc();
  }

 private:
  std::size_t unpack(std::span<char> packed, std::span<char> target) override {
    ZSTD_inBuffer in{packed.data(), packed.size(), 0};
    ZSTD_outBuffer out{target.data(), target.size(), 0};
    const std::size_t status = ZSTD_decompressStream(context_.get(), &out, &in);
    check_zstd_memory(status);
    if (ZSTD_isError(status) != 0U) throw RecordingFault("has damaged zstd data");
    if (status == 0) over();
    used(in.pos);
    return out.pos;
  }
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context_;
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
  check_zstd_memory(size);
  if (ZSTD_isError(size) != 0U || size != buffer.size()) throw RecordingFault("has a damaged packed message");
  return buffer;
}

std::unique_ptr<ByteSource> unpacked_chunk(std::unique_ptr<ByteSource> packed, std::string_view compression,
                                           std::string_view supported) {
  if (compression.empty() || compression == "none") return packed;
  if (compression == "bz2") return std::make_unique<Bzip2Chunk>(std::move(packed));
  if (compression == "lz4") return std::make_unique<Lz4Chunk>(std::move(packed));
  if (compression == "zstd") return std::make_unique<ZstdChunk>(std::move(packed));
  throw RecordingFault(fmt::format("has a chunk packed as {}; {} are read", in_quotes(compression), supported));
}

}  // namespace gdtslam

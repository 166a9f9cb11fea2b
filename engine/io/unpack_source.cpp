#include "unpack_source.hpp"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <lzma.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <new>
#include <optional>
#include <span>
#include <utility>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kPackedPieceBytes = std::size_t{1} << 16U;
constexpr std::uint64_t kMostUnpackerBytes = std::uint64_t{128} << 20U;
constexpr std::size_t kMostAtOnceBytes = std::size_t{1} << 30U;
constexpr const char* kDamagedBlock = "a block whose checksum or structure is wrong";

/// Result of one call of a library.
struct UnpackStep {
  std::size_t taken = 0;
  std::size_t given = 0;
  bool is_end = false;          ///< the stream has ended
  const char* fault = nullptr;  ///< the fault of the data; null if there is none
};

/// A library that unpacks streams in sequence.
class Unpacker {
 public:
  Unpacker() = default;
  Unpacker(const Unpacker&) = delete;
  Unpacker& operator=(const Unpacker&) = delete;
  virtual ~Unpacker() = default;
  virtual UnpackStep run(std::span<char> packed, std::span<char> target) = 0;
  /// Begins another stream after the end of one.
  virtual void restart() {}
};

class GzipUnpacker final : public Unpacker {
 public:
  GzipUnpacker() {
    constexpr int kGzipWindowBits = 15 + 16;  // largest window, gzip header expected
    if (inflateInit2(&stream_, kGzipWindowBits) != Z_OK) throw std::bad_alloc();
  }
  ~GzipUnpacker() override { inflateEnd(&stream_); }
  UnpackStep run(std::span<char> packed, std::span<char> target) override {
    stream_.next_in = reinterpret_cast<Bytef*>(packed.data());
    stream_.avail_in = static_cast<uInt>(packed.size());
    stream_.next_out = reinterpret_cast<Bytef*>(target.data());
    stream_.avail_out = static_cast<uInt>(target.size());
    const int status = inflate(&stream_, Z_NO_FLUSH);
    UnpackStep step{packed.size() - stream_.avail_in, target.size() - stream_.avail_out, status == Z_STREAM_END};
    if (status != Z_OK && status != Z_BUF_ERROR && !step.is_end) {
      step.fault = stream_.msg != nullptr ? stream_.msg : zError(status);
    }
    return step;
  }
  void restart() override { inflateReset(&stream_); }

 private:
  z_stream stream_{};
};

class Bzip2Unpacker final : public Unpacker {
 public:
  Bzip2Unpacker() { start(); }
  ~Bzip2Unpacker() override { BZ2_bzDecompressEnd(&stream_); }
  UnpackStep run(std::span<char> packed, std::span<char> target) override {
    stream_.next_in = packed.data();
    stream_.avail_in = static_cast<unsigned>(packed.size());
    stream_.next_out = target.data();
    stream_.avail_out = static_cast<unsigned>(target.size());
    const int status = BZ2_bzDecompress(&stream_);
    return {packed.size() - stream_.avail_in, target.size() - stream_.avail_out, status == BZ_STREAM_END,
            status == BZ_OK || status == BZ_STREAM_END ? nullptr : kDamagedBlock};
  }
  void restart() override {
    BZ2_bzDecompressEnd(&stream_);
    start();
  }

 private:
  void start() {
    stream_ = {};
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  bz_stream stream_{};
};

class XzUnpacker final : public Unpacker {
 public:
  XzUnpacker() { restart(); }
  ~XzUnpacker() override { lzma_end(&stream_); }
  UnpackStep run(std::span<char> packed, std::span<char> target) override {
    stream_.next_in = reinterpret_cast<const std::uint8_t*>(packed.data());
    stream_.avail_in = packed.size();
    stream_.next_out = reinterpret_cast<std::uint8_t*>(target.data());
    stream_.avail_out = target.size();
    const lzma_ret status = lzma_code(&stream_, LZMA_RUN);
    UnpackStep step{packed.size() - stream_.avail_in, target.size() - stream_.avail_out, status == LZMA_STREAM_END};
    if (status == LZMA_MEMLIMIT_ERROR) {
      step.fault = "its dictionary needs more than 128 MiB";
    } else if (status != LZMA_OK && status != LZMA_BUF_ERROR && !step.is_end) {
      step.fault = kDamagedBlock;
    }
    return step;
  }
  void restart() override {  // liblzma reuses the memory of the previous stream
    if (lzma_stream_decoder(&stream_, kMostUnpackerBytes, 0) != LZMA_OK) throw std::bad_alloc();
  }

 private:
  lzma_stream stream_ = LZMA_STREAM_INIT;
};

/// Its default limit on the window is 128 MiB. A recording may have many thousand short chunks, each a stream of its
/// own: a small context is kept for the next one.
class ZstdUnpacker final : public Unpacker {
 public:
  ZstdUnpacker() : stream_(std::exchange(spare(), nullptr)) {
    if (!stream_) stream_.reset(ZSTD_createDStream());
    if (!stream_) throw std::bad_alloc();
  }
  ~ZstdUnpacker() override {
    constexpr std::size_t kMostKeptBytes = std::size_t{1} << 20U;
    const bool is_kept = ZSTD_sizeof_DStream(stream_.get()) <= kMostKeptBytes;
    if (is_kept && ZSTD_isError(ZSTD_DCtx_reset(stream_.get(), ZSTD_reset_session_only)) == 0U) spare().swap(stream_);
  }
  UnpackStep run(std::span<char> packed, std::span<char> target) override {
    ZSTD_inBuffer from{packed.data(), packed.size(), 0};
    ZSTD_outBuffer to{target.data(), target.size(), 0};
    const std::size_t status = ZSTD_decompressStream(stream_.get(), &to, &from);
    return {from.pos, to.pos, status == 0, ZSTD_isError(status) != 0U ? ZSTD_getErrorName(status) : nullptr};
  }

 private:
  struct Free {
    void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
  };
  using Stream = std::unique_ptr<ZSTD_DStream, Free>;
  static Stream& spare() {
    thread_local Stream stream;
    return stream;
  }
  Stream stream_;
};

class Lz4Unpacker final : public Unpacker {
 public:
  Lz4Unpacker() {
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context_, LZ4F_VERSION)) != 0U) throw std::bad_alloc();
  }
  ~Lz4Unpacker() override { LZ4F_freeDecompressionContext(context_); }
  UnpackStep run(std::span<char> packed, std::span<char> target) override {
    std::size_t given = target.size();
    std::size_t taken = packed.size();
    const std::size_t status = LZ4F_decompress(context_, target.data(), &given, packed.data(), &taken, nullptr);
    return {taken, given, status == 0, LZ4F_isError(status) != 0U ? LZ4F_getErrorName(status) : nullptr};
  }

 private:
  LZ4F_dctx* context_ = nullptr;
};

/// In the order of StreamPacking.
struct PackingFormat {
  std::string_view name;          ///< also the name of the program that unpacks it
  std::optional<char> beginning;  ///< first byte of every stream; none: the library checks it
  std::unique_ptr<Unpacker> (*make)();
};
template <class T>
std::unique_ptr<Unpacker> make_unpacker() {
  return std::make_unique<T>();
}
constexpr std::array<PackingFormat, 5> kPackingFormats{{{"gzip", '\x1f', make_unpacker<GzipUnpacker>},
                                                        {"bzip2", 'B', make_unpacker<Bzip2Unpacker>},
                                                        {"xz", '\xfd', make_unpacker<XzUnpacker>},
                                                        {"zstd", std::nullopt, make_unpacker<ZstdUnpacker>},
                                                        {"lz4", std::nullopt, make_unpacker<Lz4Unpacker>}}};

/// Unpacks streams in sequence, piece by piece, and notes the defect at the end.
class UnpackSource final : public ByteSource {
 public:
  UnpackSource(StreamPacking packing, std::unique_ptr<ByteSource> packed, std::string name)
      : packed_(std::move(packed)),
        name_(std::move(name)),
        format_(kPackingFormats.at(static_cast<std::size_t>(packing))),
        unpacker_(format_.make()) {}

  std::size_t read(std::span<char> target) override {
    target = target.first(std::min(target.size(), kMostAtOnceBytes));
    while (!is_over_ && !target.empty()) {
      if (begin_ == end_ && !may_hold_more_ && !refill()) break;
      if (is_between_ && !begin_stream()) break;
      const UnpackStep step = unpacker_->run(std::span(piece_).subspan(begin_, end_ - begin_), target);
      if (step.fault != nullptr) fail(step.fault);
      begin_ += step.taken;
      is_between_ = step.is_end;
      may_hold_more_ = step.given == target.size() && !step.is_end;
      if (step.given > 0) return step.given;
    }
    return 0;
  }
  [[nodiscard]] double progress() const override { return packed_->progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return packed_->bytes_from_file(); }
  [[nodiscard]] std::string defect() const override { return defect_; }

 private:
  bool refill() {
    begin_ = 0;
    end_ = packed_->read(piece_);
    if (end_ > 0) return true;
    is_over_ = true;
    if (!is_between_) defect_ = fmt::format("the {} stream stops early", format_.name);
    return false;
  }

  /// After a stream: begins another one, or ignores other bytes, as the programs do.
  bool begin_stream() {
    if (format_.beginning && piece_[begin_] != *format_.beginning) {
      is_over_ = true;
      defect_ = fmt::format("bytes after the {} stream are ignored", format_.name);
      return false;
    }
    unpacker_->restart();
    return true;
  }

  [[noreturn]] void fail(std::string_view why) const {
    throw InputError({name_, 0}, fmt::format("damaged {0} data ({1}); unpack it with {0} -dc to save what can be read",
                                             format_.name, why));
  }

  std::unique_ptr<ByteSource> packed_;
  std::string name_;
  const PackingFormat& format_;
  std::unique_ptr<Unpacker> unpacker_;
  std::array<char, kPackedPieceBytes> piece_;  // not zeroed, which would take longer than a short stream
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool may_hold_more_ = false;
  bool is_between_ = false;
  bool is_over_ = false;
  std::string defect_;
};

}  // namespace

std::unique_ptr<ByteSource> unpack_source(StreamPacking packing, std::unique_ptr<ByteSource> packed, std::string name) {
  return std::make_unique<UnpackSource>(packing, std::move(packed), std::move(name));
}

std::unique_ptr<ByteSource> gunzip_if_packed(std::unique_ptr<ByteSource> packed, const std::string& name) {
  std::string head = read_head(*packed, kGzipMagic.size());
  const bool is_packed = head == kGzipMagic;
  packed = with_head(std::move(head), std::move(packed));
  return is_packed ? unpack_source(StreamPacking::kGzip, std::move(packed), name) : std::move(packed);
}

}  // namespace gdtslam

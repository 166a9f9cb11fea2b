#include "unpack_source.hpp"

#include <bzlib.h>
#include <fmt/format.h>
#include <lzma.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <new>
#include <span>
#include <utility>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kPackedPieceBytes = std::size_t{1} << 16U;
constexpr std::uint64_t kMostUnpackerBytes = std::uint64_t{128} << 20U;
constexpr std::size_t kMostAtOnceBytes = std::size_t{1} << 30U;

/// What the three have in common: pieces of packed bytes, the end, what is wrong with it.
class UnpackSource : public ByteSource {
 public:
  UnpackSource(std::unique_ptr<ByteSource> packed, std::string name, std::string_view format, std::string_view program)
      : packed_(std::move(packed)), name_(std::move(name)), format_(format), program_(program) {}

  std::size_t read(std::span<char> target) override {
    target = target.first(std::min(target.size(), kMostAtOnceBytes));
    while (!is_over_ && !target.empty()) {
      if (begin_ == end_ && !may_hold_more_) refill();
      if (is_over_) break;
      const std::size_t count = unpack(std::span(piece_).subspan(begin_, end_ - begin_), target);
      may_hold_more_ = count == target.size();
      if (count > 0) return count;
    }
    return 0;
  }
  [[nodiscard]] double progress() const override { return packed_->progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return packed_->bytes_from_file(); }
  [[nodiscard]] std::string defect() const override { return defect_; }

 protected:
  /// Unpacks some bytes, and calls used() and set_between().
  virtual std::size_t unpack(std::span<char> packed, std::span<char> target) = 0;
  void used(std::size_t count) { begin_ += count; }
  /// Whether a stream has ended and no other has begun.
  void set_between(bool is_between) { is_between_ = is_between; }
  [[nodiscard]] bool is_between() const { return is_between_; }
  void ignore_rest() {
    is_over_ = true;
    defect_ = fmt::format("bytes after the {} stream are ignored", format_);
  }
  [[noreturn]] void fail(std::string_view why) const {
    throw InputError({name_, 0}, fmt::format("damaged {} data ({}); unpack it with {} -dc to save what can be read",
                                             format_, why, program_));
  }
  [[noreturn]] void fail_to_start() const {
    throw Error(ExitCode::kFailed, located({name_, 0}, fmt::format("{} cannot be started (out of memory)", format_)));
  }

 private:
  void refill() {
    begin_ = 0;
    end_ = packed_->read(piece_);
    if (end_ > 0) return;
    is_over_ = true;
    if (!is_between_) defect_ = fmt::format("the {} stream stops early", format_);
  }

  std::unique_ptr<ByteSource> packed_;
  std::string name_;
  std::string_view format_;
  std::string_view program_;
  std::array<char, kPackedPieceBytes> piece_;  // no zeros, which would take longer than a short stream
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool may_hold_more_ = false;
  bool is_between_ = false;
  bool is_over_ = false;
  std::string defect_;
};

class Bunzip2Source final : public UnpackSource {
 public:
  Bunzip2Source(std::unique_ptr<ByteSource> packed, std::string name)
      : UnpackSource(std::move(packed), std::move(name), "bzip2", "bzip2") {
    start();
  }
  ~Bunzip2Source() override { BZ2_bzDecompressEnd(&stream_); }

 private:
  void start() {
    stream_ = {};
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) fail_to_start();
  }
  std::size_t unpack(std::span<char> packed, std::span<char> target) override {
    if (is_ended_) {
      if (packed.empty()) return 0;
      if (packed.front() != 'B') {
        ignore_rest();
        return 0;
      }
      BZ2_bzDecompressEnd(&stream_);
      start();
      is_ended_ = false;
      set_between(false);
    }
    stream_.next_in = packed.data();
    stream_.avail_in = static_cast<unsigned>(packed.size());
    stream_.next_out = target.data();
    stream_.avail_out = static_cast<unsigned>(target.size());
    const int status = BZ2_bzDecompress(&stream_);
    if (status == BZ_MEM_ERROR) throw std::bad_alloc();
    if (status != BZ_OK && status != BZ_STREAM_END) fail("a block whose checksum or structure is wrong");
    used(packed.size() - stream_.avail_in);
    if (status == BZ_STREAM_END) {
      is_ended_ = true;
      set_between(true);
    }
    return target.size() - stream_.avail_out;
  }

  bz_stream stream_{};
  bool is_ended_ = false;
};

class UnxzSource final : public UnpackSource {
 public:
  UnxzSource(std::unique_ptr<ByteSource> packed, std::string name)
      : UnpackSource(std::move(packed), std::move(name), "xz", "xz") {
    start();
  }
  ~UnxzSource() override { lzma_end(&stream_); }

 private:
  void start() {
    if (lzma_stream_decoder(&stream_, kMostUnpackerBytes, 0) != LZMA_OK) fail_to_start();
  }
  std::size_t unpack(std::span<char> packed, std::span<char> target) override {
    if (is_ended_) {
      if (packed.empty()) return 0;
      if (packed.front() != '\xfd') {
        ignore_rest();
        return 0;
      }
      start();  // liblzma takes its memory over
      is_ended_ = false;
      set_between(false);
    }
    stream_.next_in = reinterpret_cast<const std::uint8_t*>(packed.data());
    stream_.avail_in = packed.size();
    stream_.next_out = reinterpret_cast<std::uint8_t*>(target.data());
    stream_.avail_out = target.size();
    const lzma_ret status = lzma_code(&stream_, LZMA_RUN);
    if (status == LZMA_MEM_ERROR) throw std::bad_alloc();
    if (status == LZMA_MEMLIMIT_ERROR) fail("its dictionary needs more than 128 MiB");
    if (status != LZMA_OK && status != LZMA_STREAM_END && status != LZMA_BUF_ERROR) {
      fail("a block whose checksum or structure is wrong");
    }
    used(packed.size() - stream_.avail_in);
    if (status == LZMA_STREAM_END) {
      is_ended_ = true;
      set_between(true);
    }
    return target.size() - stream_.avail_out;
  }

  lzma_stream stream_ = LZMA_STREAM_INIT;
  bool is_ended_ = false;
};

class UnzstdSource final : public UnpackSource {
 public:
  UnzstdSource(std::unique_ptr<ByteSource> packed, std::string name)
      : UnpackSource(std::move(packed), std::move(name), "zstd", "zstd"), stream_(ZSTD_createDStream()) {
    if (!stream_) fail_to_start();  // its window is at most 128 MiB, unless it is told otherwise
  }

 private:
  struct FreeStream {
    void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
  };
  std::size_t unpack(std::span<char> packed, std::span<char> target) override {
    if (packed.empty() && is_between()) return 0;  // asked once more, zstd would begin another stream
    ZSTD_inBuffer from{packed.data(), packed.size(), 0};
    ZSTD_outBuffer to{target.data(), target.size(), 0};
    const std::size_t status = ZSTD_decompressStream(stream_.get(), &to, &from);
    check_zstd_memory(status);
    if (ZSTD_isError(status) != 0U) fail(ZSTD_getErrorName(status));
    used(from.pos);
    set_between(status == 0);
    return to.pos;
  }

  std::unique_ptr<ZSTD_DStream, FreeStream> stream_;
};

}  // namespace

void check_zstd_memory(std::size_t result) {
  if (ZSTD_getErrorCode(result) == ZSTD_error_memory_allocation) throw std::bad_alloc();
}

std::unique_ptr<ByteSource> unpack_source(StreamPacking packing, std::unique_ptr<ByteSource> packed, std::string name) {
  if (packing == StreamPacking::kBzip2) return std::make_unique<Bunzip2Source>(std::move(packed), std::move(name));
  if (packing == StreamPacking::kXz) return std::make_unique<UnxzSource>(std::move(packed), std::move(name));
  return std::make_unique<UnzstdSource>(std::move(packed), std::move(name));
}

}  // namespace gdtslam

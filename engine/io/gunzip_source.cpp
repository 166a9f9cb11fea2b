#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>

#include "byte_source.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kPackedChunkBytes = std::size_t{1} << 16;
constexpr int kGzipWindowBits = 15 + 16;  // largest window, gzip header expected

/// Hands out the bytes already read for the guess, then the rest.
class PeekedSource final : public ByteSource {
 public:
  PeekedSource(std::unique_ptr<ByteSource> rest, std::array<char, 2> head, std::size_t head_size)
      : rest_(std::move(rest)), head_(head), head_size_(head_size) {}
  std::size_t read(std::span<char> target) override {
    if (head_position_ == head_size_) {
      return rest_->read(target);
    }
    const std::size_t count = std::min(target.size(), head_size_ - head_position_);
    std::memcpy(target.data(), head_.data() + head_position_, count);
    head_position_ += count;
    return count;
  }
  [[nodiscard]] double progress() const override { return rest_->progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return rest_->bytes_from_file(); }

 private:
  std::unique_ptr<ByteSource> rest_;
  std::array<char, 2> head_;
  std::size_t head_size_;
  std::size_t head_position_ = 0;
};

/// Unpacks one gzip member after the other, as gunzip does.
class GunzipSource final : public ByteSource {
 public:
  GunzipSource(std::unique_ptr<ByteSource> packed, std::string name)
      : packed_(std::move(packed)), name_(std::move(name)) {
    if (inflateInit2(&stream_, kGzipWindowBits) != Z_OK) {
      throw Error(ExitCode::kFailed, located({name_, 0}, "zlib cannot be started (out of memory)"));
    }
  }
  ~GunzipSource() override { inflateEnd(&stream_); }

  std::size_t read(std::span<char> target) override {
    while (!at_end_) {
      if (stream_.avail_in == 0 && !refill()) {
        break;
      }
      if (between_members_ && !start_member()) {
        break;
      }
      const std::size_t count = inflate_into(target);
      if (count > 0) {
        return count;
      }
    }
    return 0;
  }
  [[nodiscard]] double progress() const override { return packed_->progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return packed_->bytes_from_file(); }
  [[nodiscard]] std::string defect() const override { return defect_; }

 private:
  bool refill() {
    const std::size_t count = packed_->read(buffer_);
    stream_.next_in = reinterpret_cast<Bytef*>(buffer_.data());
    stream_.avail_in = static_cast<uInt>(count);
    if (count == 0) {
      at_end_ = true;
      if (!between_members_) {
        defect_ = "the gzip stream stops early";
      }
    }
    return count > 0;
  }

  /// After a member: another one, or bytes that are no gzip, which gunzip ignores too.
  bool start_member() {
    if (*stream_.next_in != 0x1f) {
      at_end_ = true;
      defect_ = "bytes after the gzip stream are ignored";
      return false;
    }
    inflateReset(&stream_);
    between_members_ = false;
    return true;
  }

  std::size_t inflate_into(std::span<char> target) {
    stream_.next_out = reinterpret_cast<Bytef*>(target.data());
    stream_.avail_out = static_cast<uInt>(std::min(target.size(), std::size_t{1} << 30));
    const uInt room = stream_.avail_out;
    const int status = inflate(&stream_, Z_NO_FLUSH);
    if (status == Z_STREAM_END) {
      between_members_ = true;
    } else if (status == Z_MEM_ERROR) {
      throw std::bad_alloc();
    } else if (status != Z_OK && status != Z_BUF_ERROR) {
      throw InputError({name_, 0},
                       fmt::format("damaged gzip data ({}); unpack it with gzip -dc to save what can be read",
                                   stream_.msg != nullptr ? stream_.msg : zError(status)));
    }
    return room - stream_.avail_out;
  }

  std::unique_ptr<ByteSource> packed_;
  std::string name_;
  z_stream stream_{};
  std::array<char, kPackedChunkBytes> buffer_;  // no zeros, which would take longer than a short stream
  bool between_members_ = false;
  bool at_end_ = false;
  std::string defect_;
};

}  // namespace

std::unique_ptr<ByteSource> gunzip_if_packed(std::unique_ptr<ByteSource> packed, const std::string& name) {
  std::array<char, 2> head{};
  std::size_t size = 0;
  while (size < head.size()) {
    const std::size_t count = packed->read(std::span(head).subspan(size));
    if (count == 0) {
      break;
    }
    size += count;
  }
  auto peeked = std::make_unique<PeekedSource>(std::move(packed), head, size);
  if (size == 2 && head[0] == '\x1f' && head[1] == '\x8b') {
    return std::make_unique<GunzipSource>(std::move(peeked), name);
  }
  return peeked;
}

}  // namespace gdtslam

#include "log_copy.hpp"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "engine/io/unpack_source.hpp"
#include "engine/io/warning_counter.hpp"
#include "gdtslam/core/error.hpp"
#include "log_copy_writer.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostFrameBytes = std::uint32_t{64} << 20U;  // packed, and unpacked
constexpr std::size_t kFramePieceBytes = std::size_t{1} << 16U;
constexpr std::array<std::string_view, std::variant_size_v<LogRecord>> kCopiedNames{"scans", "odometry", "ticks",
                                                                                    "elevations", "parameters"};

/// What is wrong with a frame.
struct FrameFault {
  std::string text;
  bool is_cut = false;  ///< the file ends within it
};

/// The frames of a copy, one after the other, as they are packed.
class FrameReader {
 public:
  FrameReader(std::unique_ptr<ByteSource> source, std::string name)
      : source_(std::move(source)), name_(std::move(name)) {
    const std::string head = read(kLogCopyHeadBytes);
    if (!head.starts_with(kLogCopyMagic) || head.size() < kLogCopyHeadBytes) {
      throw InputError({name_, 0}, "holds no copy of a log");
    }
    const std::string_view number = std::string_view(head).substr(kLogCopyMagic.size());
    const std::uint32_t version = BytesIn(number, name_).whole();
    if (version != kLogCopyVersion) {
      throw InputError({name_, 0}, fmt::format("is a log copy of version {}, and this program reads version {}",
                                               version, kLogCopyVersion));
    }
  }
  /// Nothing at the end. Throws FrameFault.
  std::optional<LogCopyFrame> next() {
    begin_ = at_;
    const std::string head = read(kLogCopyFrameBytes);
    if (head.empty()) return std::nullopt;
    if (head.size() < kLogCopyFrameBytes) throw FrameFault{"ends within a frame", true};
    BytesIn in(head, name_);
    LogCopyFrame frame;
    frame.packed_bytes = in.whole();
    frame.records = in.whole();
    frame.checksum = in.whole();
    if (frame.packed_bytes > kMostFrameBytes) throw FrameFault{"has a frame of more than 64 MiB"};
    packed_ = read(frame.packed_bytes);
    if (packed_.size() < frame.packed_bytes) throw FrameFault{"ends within a frame", true};
    if (log_copy_checksum(frame.records, packed_) != frame.checksum) {
      throw FrameFault{"has a frame whose checksum is that of other bytes"};
    }
    return frame;
  }
  /// The last one.
  [[nodiscard]] const std::string& packed() const { return packed_; }
  [[nodiscard]] std::uint64_t begin() const { return begin_; }
  [[nodiscard]] std::uint64_t end() const { return at_; }
  [[nodiscard]] const ByteSource& source() const { return *source_; }

 private:
  // In pieces: the size that a file states is not believed until the bytes have come.
  std::string read(std::size_t size) {
    std::string bytes;
    while (bytes.size() < size) {
      const std::size_t old_size = bytes.size();
      bytes.resize(old_size + std::min(size - old_size, kFramePieceBytes));
      const std::size_t count = source_->read({bytes.data() + old_size, bytes.size() - old_size});
      bytes.resize(old_size + count);
      if (count == 0) break;
    }
    at_ += bytes.size();
    return bytes;
  }

  std::unique_ptr<ByteSource> source_;
  std::string name_;
  std::string packed_;
  std::uint64_t begin_ = 0;
  std::uint64_t at_ = 0;
};

class FrameUnpacker {
 public:
  FrameUnpacker() : context_(ZSTD_createDCtx()) {
    if (!context_) throw Error(ExitCode::kFailed, "zstd cannot be started (out of memory)");
  }
  /// Throws FrameFault.
  std::string unpacked(const std::string& packed) {
    ZSTD_DCtx_reset(context_.get(), ZSTD_reset_session_only);
    std::string raw;
    ZSTD_inBuffer from{packed.data(), packed.size(), 0};
    for (std::size_t status = 1; status != 0;) {
      const std::size_t old_size = raw.size();
      raw.resize(old_size + kFramePieceBytes);
      ZSTD_outBuffer to{raw.data() + old_size, kFramePieceBytes, 0};
      status = ZSTD_decompressStream(context_.get(), &to, &from);
      raw.resize(old_size + to.pos);
      check_zstd_memory(status);
      const bool is_stuck = status != 0 && to.pos == 0 && from.pos == from.size;
      if (ZSTD_isError(status) != 0U || is_stuck) throw FrameFault{"has a frame that cannot be unpacked"};
      if (raw.size() > kMostFrameBytes) throw FrameFault{"has a frame of more than 64 MiB"};
    }
    if (from.pos != from.size) throw FrameFault{"has a frame that goes on behind its end"};
    return raw;
  }

 private:
  struct FreeUnpacker {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };
  std::unique_ptr<ZSTD_DCtx, FreeUnpacker> context_;
};

class LogCopyReader final : public DescribedLog {
 public:
  LogCopyReader(std::unique_ptr<ByteSource> source, const std::string& name, const ReadOptions& options)
      : name_(name), options_(options), frames_(std::move(source), name) {}

  std::optional<LogRecord> next() override {
    while (left_ == 0) {
      if (is_over_) return std::nullopt;
      next_frame();
    }
    LogRecord record = coder_.record_from(*in_);
    if (--left_ == 0 && in_->left() > 0) in_->refuse("goes on behind its last record");
    kinds_.add(kCopiedNames.at(record.index()), true);
    if (auto* scan = std::get_if<ScanRecord>(&record)) state(scan->scan);
    return record;
  }
  [[nodiscard]] double progress() const override { return frames_.source().progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return warnings_.list(); }
  [[nodiscard]] LogContents contents() const override {
    LogContents contents;
    contents.format = "log copy";
    contents.lines = kinds_.list();
    return contents;
  }

 private:
  void next_frame() {
    try {
      const std::optional<LogCopyFrame> frame = frames_.next();
      if (!frame) throw FrameFault{"has no end: the run that made it was killed, or it was cut", true};
      raw_ = unpacker_.unpacked(frames_.packed());
      frame_name_ = fmt::format("{} (frame at byte {})", name_, frames_.begin());
      in_.emplace(raw_, frame_name_);
      if (frame->records > raw_.size()) throw FrameFault{"has a frame of more records than bytes"};
      coder_.begin_frame();
      left_ = frame->records;
      if (left_ == 0) finish(end_from(*in_));
    } catch (const FrameFault& fault) {
      refuse(fault);
    }
  }
  void finish(const LogCopyEnd& end) {
    is_over_ = true;
    for (const Warning& warning : end.warnings) warnings_.add(warning.kind, warning.first, warning.count);
    if (frames_.next()) throw FrameFault{"goes on behind its end"};
  }
  void refuse(const FrameFault& fault) {
    is_over_ = true;
    const std::string text = fmt::format("at byte {}: {}", frames_.begin(), fault.text);
    if (!fault.is_cut && !options_.lenient) {
      throw InputError({name_, 0}, text + "; --lenient takes what is before");
    }
    warnings_.add(fault.is_cut ? "cut log copy" : "damaged log copy", located({name_, 0}, text));
  }
  /// What is stated beside the log, as every reader does.
  void state(LaserScan& scan) const {
    scan.first_bearing_rad = options_.first_bearing_rad.value_or(scan.first_bearing_rad);
    scan.bearing_step_rad = options_.bearing_step_rad.value_or(scan.bearing_step_rad);
    scan.max_range_m = options_.max_range_m.value_or(scan.max_range_m);
    scan.T_base_laser = options_.T_base_laser.value_or(scan.T_base_laser);
  }

  std::string name_;
  ReadOptions options_;
  FrameReader frames_;
  FrameUnpacker unpacker_;
  std::string raw_;         ///< the frame in hand, unpacked
  std::string frame_name_;  ///< in messages
  std::optional<BytesIn> in_;
  RecordCoder coder_;
  std::uint32_t left_ = 0;  ///< records in it
  bool is_over_ = false;
  WarningCounter warnings_;
  LineCounter kinds_;
};

}  // namespace

std::unique_ptr<DescribedLog> open_log_copy(std::unique_ptr<ByteSource> source, const std::string& name,
                                            const ReadOptions& options) {
  return std::make_unique<LogCopyReader>(std::move(source), name, options);
}

std::unique_ptr<DescribedLog> open_log_copy(std::span<const std::byte> data, const std::string& name,
                                            const ReadOptions& options) {
  return open_log_copy(open_memory_source(data), name, options);
}

LogCopyExtent extent_of_log_copy(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::file_size(path, ignored) < kLogCopyHeadBytes && !ignored) return {};
  FrameReader frames(open_file_source(path), path);
  LogCopyExtent extent{
      .records = 0, .whole_bytes = kLogCopyHeadBytes, .sure_records = 0, .sure_bytes = kLogCopyHeadBytes, .end = {}};
  try {
    while (const std::optional<LogCopyFrame> frame = frames.next()) {
      if (frame->records == 0) {
        const std::string raw = FrameUnpacker().unpacked(frames.packed());
        BytesIn in(raw, path);
        extent.end = end_from(in);
        break;
      }
      extent.sure_records = std::exchange(extent.records, extent.records + frame->records);
      extent.sure_bytes = std::exchange(extent.whole_bytes, frames.end());
    }
  } catch (const FrameFault&) {  // all before it holds
  }
  if (!extent.end) {
    extent.sure_records = extent.records;
    extent.sure_bytes = extent.whole_bytes;
  }
  return extent;
}

}  // namespace gdtslam

#include "gdtslam/io/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>

#include "carmen.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/recordings/recording_reader.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// What every refusal ends with.
std::string supported() { return fmt::format("supported are {} logs, plain or gzip", kLogFormats); }

using OpenUnpacked = std::unique_ptr<LogReader> (*)(std::unique_ptr<ByteSource>, const std::string&,
                                                    const ReadOptions&);

/// The first bytes of a container: what reads it or, where nothing does, what it is.
struct Magic {
  std::string_view bytes;
  std::string_view kind;
  OpenUnpacked open = nullptr;
};
constexpr std::string_view kSqliteHead = "SQLite format 3";
constexpr std::array<Magic, 6> kMagics = {
    {{"#ROSBAG V", "", open_bag},
     {"\x89MCAP", "", open_mcap},
     {kSqliteHead, "an SQLite file, which cannot be read from a pipe (give its name)"},
     {"BZh", "bzip2 data"},
     {"\xfd"
      "7zXZ",
      "xz data"},
     {"\x28\xb5\x2f\xfd", "zstd data"}}};

bool may_be_magic(std::string_view head) {
  return std::any_of(kMagics.begin(), kMagics.end(),
                     [head](const Magic& magic) { return magic.bytes.starts_with(head); });
}

/// The first bytes, as many as tell the kind, and no more: those of a pipe come only once, and late.
std::string head_of(ByteSource& source) {
  std::string head;
  for (char byte = 0; may_be_magic(head) && source.read({&byte, 1}) == 1;) head.push_back(byte);
  return head;
}

/// The bytes that were read to tell the kind, then the rest.
class HeadedSource final : public ByteSource {
 public:
  HeadedSource(std::string head, std::unique_ptr<ByteSource> rest) : head_(std::move(head)), rest_(std::move(rest)) {}
  std::size_t read(std::span<char> target) override {
    if (begin_ == head_.size()) return rest_->read(target);
    const std::size_t count = head_.copy(target.data(), target.size(), begin_);
    begin_ += count;
    return count;
  }
  [[nodiscard]] double progress() const override { return rest_->progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return rest_->bytes_from_file(); }
  [[nodiscard]] std::string defect() const override { return rest_->defect(); }

 private:
  std::string head_;
  std::size_t begin_ = 0;
  std::unique_ptr<ByteSource> rest_;
};

}  // namespace

std::unique_ptr<LogReader> open_log(const std::string& path, const ReadOptions& options) {
  std::error_code ignored;
  if (path != "-" && std::filesystem::is_directory(path, ignored)) return open_ros2_bag(path, options);
  const std::string name = path == "-" ? "standard input" : path;
  std::unique_ptr<ByteSource> source = gunzip_if_packed(open_file_source(path), name);
  const std::string head = head_of(*source);
  source = std::make_unique<HeadedSource>(head, std::move(source));
  for (const Magic& magic : kMagics) {
    if (!head.starts_with(magic.bytes)) continue;
    if (magic.bytes == kSqliteHead && path != "-") return open_ros2_bag(path, options);
    if (magic.open != nullptr) return magic.open(std::move(source), name, options);
    throw InputError({name, 0}, fmt::format("is {}; {}", magic.kind, supported()));
  }
  return open_carmen(std::move(source), name, options);
}

}  // namespace gdtslam

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
#include "engine/io/log_contents.hpp"
#include "engine/io/recordings/recording_reader.hpp"
#include "engine/io/tables/table_reader.hpp"
#include "engine/io/unpack_source.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// The end of every refusal.
std::string supported() {
  return fmt::format("supported are {} logs, plain or packed by gzip, bzip2, xz or zstd", kLogFormats);
}

using OpenUnpacked = std::unique_ptr<DescribedLog> (*)(std::unique_ptr<ByteSource>, const std::string&,
                                                       const ReadOptions&);

/// The first bytes of a container, and its reader, its packing or, if it is not supported, its name.
struct Magic {
  std::string_view bytes;
  std::string_view kind;
  OpenUnpacked open = nullptr;
  std::optional<StreamPacking> packing{};
};
constexpr std::string_view kSqliteHead = "SQLite format 3";
constexpr std::array<Magic, 6> kMagics = {
    {{"#ROSBAG V", "", open_bag},
     {"\x89MCAP", "", open_mcap},
     {kSqliteHead, "an SQLite file, which cannot be read from a pipe (give its name)"},
     {kBzip2Magic, "bzip2 data", nullptr, StreamPacking::kBzip2},
     {kXzMagic, "xz data", nullptr, StreamPacking::kXz},
     {kZstdMagic, "zstd data", nullptr, StreamPacking::kZstd}}};

bool may_be_magic(std::string_view head) {
  return std::any_of(kMagics.begin(), kMagics.end(),
                     [head](const Magic& magic) { return magic.bytes.starts_with(head); });
}

/// Reads only as many first bytes as decide the kind, because bytes of a pipe come only once, and late.
std::string read_magic(ByteSource& source) {
  std::string head;
  for (char byte = 0; may_be_magic(head) && source.read({&byte, 1}) == 1;) head.push_back(byte);
  return head;
}

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '"';
}

/// A line of JSON begins with a brace; a header of CSV with a name and a comma, a line of CARMEN with a name and a
/// blank. Reads up to there.
std::optional<TableKind> detect_table(ByteSource& source, std::string& head) {
  static constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  static constexpr std::size_t kLongestName = 64;
  const auto text_behind_mark = [&head] {
    const std::string_view text = head;
    return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
  };
  const auto goes_on = [](std::string_view text) {
    return kByteOrderMark.starts_with(text) || (text.size() < kLongestName && is_name_character(text.back()));
  };
  for (char byte = 0; goes_on(text_behind_mark()) && source.read({&byte, 1}) == 1;) head.push_back(byte);
  const std::string_view text = text_behind_mark();
  if (text.starts_with('{')) return TableKind::kJsonLines;
  const bool has_name = text.size() > 1 && is_name_character(text[text.size() - 2]);
  return has_name && (text.ends_with(',') || text.ends_with(';')) ? std::optional(TableKind::kCsv) : std::nullopt;
}

/// Unpacks packed data once, because no log is packed twice. `head`: the bytes read to recognise it.
std::unique_ptr<ByteSource> unpacked(std::unique_ptr<ByteSource> source, const std::string& name, std::string& head) {
  source = gunzip_if_packed(std::move(source), name);
  head = read_magic(*source);
  for (const Magic& magic : kMagics) {
    if (!magic.packing || !head.starts_with(magic.bytes)) continue;
    source = unpack_source(*magic.packing, with_head(head, std::move(source)), name);
    head = read_magic(*source);
    break;
  }
  return source;
}

/// Text logs have one laser's scans and one odometry, so there is no choice.
void refuse_topics(const TopicChoice& chosen, const std::string& name, std::string_view kind) {
  const auto refuse = [&](std::string_view what) {
    throw UsageError(fmt::format("{}: is {}, which has no topics: leave out {}", name, kind, what));
  };
  if (!chosen.scans.empty()) refuse("--topic");
  if (!chosen.odometry.empty()) refuse("--odom");
  if (!chosen.crank.empty()) refuse("--crank");
  if (!chosen.mounts.empty()) refuse("the name in --mount NAME=x,y,yaw");
}

/// Bytes of the caller.
class LentSource final : public ByteSource {
 public:
  explicit LentSource(ReadBytes read) : read_(std::move(read)) {}
  std::size_t read(std::span<char> target) override {
    const std::size_t count = read_(target);
    bytes_ += count;
    return count;
  }
  [[nodiscard]] double progress() const override { return -1.0; }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return bytes_; }

 private:
  ReadBytes read_;
  std::uint64_t bytes_ = 0;
};

// `path` is empty if the bytes have none.
std::unique_ptr<DescribedLog> open_source(std::unique_ptr<ByteSource> packed, const std::string& name,
                                          const std::string& path, const ReadOptions& options) {
  std::string head;
  std::unique_ptr<ByteSource> source = unpacked(std::move(packed), name, head);
  const std::optional<TableKind> table = detect_table(*source, head);
  source = with_head(head, std::move(source));
  if (table) {
    refuse_topics(options.topics, name, *table == TableKind::kCsv ? "a CSV file" : "a file of JSON lines");
    return open_table(*table, std::move(source), name, options);
  }
  for (const Magic& magic : kMagics) {
    if (!head.starts_with(magic.bytes)) continue;
    if (magic.bytes == kSqliteHead && !path.empty()) return open_ros2_bag(path, options);
    if (magic.open != nullptr) return magic.open(std::move(source), name, options);
    throw InputError({name, 0}, fmt::format("is {}; {}", magic.kind, supported()));
  }
  if (!head.empty())
    refuse_topics(options.topics, name, "a CARMEN log");  // a log that ended before it began has no kind
  return open_carmen(std::move(source), name, options);
}

}  // namespace

std::unique_ptr<LogReader> open_log(const std::string& path, const ReadOptions& options) {
  return open_described_log(path, options);
}

std::unique_ptr<LogReader> open_log_of_bytes(ReadBytes read, const std::string& name, const ReadOptions& options) {
  return open_source(std::make_unique<LentSource>(std::move(read)), name, "", options);
}

std::unique_ptr<DescribedLog> open_described_log(const std::string& path, const ReadOptions& options) {
  std::error_code ignored;
  if (path == "-") return open_source(open_file_source(path), "standard input", "", options);
  if (std::filesystem::is_directory(path, ignored)) return open_ros2_bag(path, options);
  return open_source(open_file_source(path), path, path, options);
}

}  // namespace gdtslam

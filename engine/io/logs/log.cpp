#include "gdtslam/io/log.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <string_view>

#include "carmen.hpp"
#include "engine/io/byte_source.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// What every refusal ends with.
std::string supported() { return fmt::format("supported are {} text logs, plain or gzip", kLogFormats); }

/// What the first bytes say about a container that is not read; empty when they say nothing.
std::string_view foreign_kind(std::string_view head) {
  struct Magic {
    std::string_view bytes;
    std::string_view kind;
  };
  static constexpr std::array<Magic, 6> kMagics = {{{"#ROSBAG V", "a ROS 1 bag"},
                                                    {"\x89MCAP0\r\n", "an MCAP file"},
                                                    {"SQLite format 3", "an SQLite file (a ROS 2 bag?)"},
                                                    {"BZh", "bzip2 data"},
                                                    {"\xfd"
                                                     "7zXZ",
                                                     "xz data"},
                                                    {"\x28\xb5\x2f\xfd", "zstd data"}}};
  for (const Magic& magic : kMagics) {
    if (head.starts_with(magic.bytes)) {
      return magic.kind;
    }
  }
  return {};
}

/// The beginning of a file, unpacked; never called for standard input, whose bytes come only once.
std::string head_of(const std::string& path) {
  constexpr std::size_t kHeadBytes = 16;
  const std::unique_ptr<ByteSource> source = gunzip_if_packed(open_file_source(path), path);
  std::string head(kHeadBytes, '\0');
  std::size_t size = 0;
  while (size < head.size()) {
    const std::size_t count = source->read({head.data() + size, head.size() - size});
    if (count == 0) {
      break;
    }
    size += count;
  }
  head.resize(size);
  return head;
}

}  // namespace

std::unique_ptr<LogReader> open_log(const std::string& path, const ReadOptions& options) {
  std::error_code ignored;
  if (path != "-" && std::filesystem::is_directory(path, ignored)) {
    const bool is_bag = std::filesystem::exists(std::filesystem::path(path) / "metadata.yaml", ignored);
    throw InputError({path, 0}, fmt::format("is {}; {}", is_bag ? "a ROS 2 bag" : "a folder", supported()));
  }
  if (path != "-" && std::filesystem::is_regular_file(path, ignored)) {
    const std::string_view kind = foreign_kind(head_of(path));
    if (!kind.empty()) {
      throw InputError({path, 0}, fmt::format("is {}; {}", kind, supported()));
    }
  }
  return open_carmen(path, options);
}

}  // namespace gdtslam

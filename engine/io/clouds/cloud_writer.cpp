#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "engine/io/atomic_file.hpp"
#include "engine/io/little_endian.hpp"
#include "engine/io/referenced_file.hpp"
#include "engine/io/sha256.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kPiece = 4096;
constexpr std::size_t kCountDigits = 20;

void append_binary(std::string& bytes, const CloudPoint& point) {
  for (const float value : {point.x_m, point.y_m, point.z_m, point.elevation_rad}) append_little_endian(bytes, value);
  append_little_endian(bytes, point.stamp_s);
  append_little_endian(bytes, point.scan);
}

// The header has the same length for any count: blanks in a comment replace the missing digits.
std::string format_header(CloudFormat format, std::uint64_t points) {
  const std::string count = std::to_string(points);
  const bool is_ply = format == CloudFormat::kPlyBinary;
  const std::string blanks((kCountDigits - count.size()) * (is_ply ? 1 : 2), ' ');
  if (is_ply) {
    return fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment gdtslam; metres, radians, seconds; frame map{}\n"
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float elevation\n"
        "property double time\nproperty uint scan\nend_header\n",
        blanks, count);
  }
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\n# gdtslam; metres, radians, seconds; frame map{}\nVERSION 0.7\n"
      "FIELDS x y z elevation time scan\nSIZE 4 4 4 4 8 4\nTYPE F F F F F U\nCOUNT 1 1 1 1 1 1\nWIDTH {}\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
      blanks, count, count);
}

// Checked before writing, because the start of a pipe or a device cannot be rewritten.
const std::string& seekable(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status) ||
      std::filesystem::is_directory(status)) {
    return path;
  }
  throw FileError(path,
                  "is a pipe or a device: a cloud begins with its number of points, which is known last; "
                  "name a file");
}

}  // namespace

CloudFormat find_cloud_format(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension == ".ply") return CloudFormat::kPlyBinary;
  if (extension == ".pcd") return CloudFormat::kPcdBinary;
  throw UsageError(path + ": the name of a cloud ends in .ply or .pcd");
}

struct CloudWriter::State {
  AtomicFile file;
  CloudFormat format;
  Sha256 hash;
  std::string sha256;
  std::uint64_t points = 0;
  std::string binary;
};

CloudWriter::CloudWriter(const std::string& path, CloudFormat format)
    : state_(new State{.file = AtomicFile(seekable(path)), .format = format, .hash = {}, .sha256 = {}, .binary = {}}) {
  state_->file.write(format_header(format, 0));
}

CloudWriter::~CloudWriter() = default;

void CloudWriter::add(std::span<const CloudPoint> points) {
  State& s = *state_;
  while (!points.empty()) {
    const std::span<const CloudPoint> piece = points.first(std::min(points.size(), kPiece));
    points = points.subspan(piece.size());
    s.binary.clear();
    for (const CloudPoint& point : piece) append_binary(s.binary, point);
    s.hash.update(s.binary);
    s.file.write(s.binary);
    s.points += piece.size();
  }
}

void CloudWriter::finish() {
  State& s = *state_;
  s.file.rewrite_begin(format_header(s.format, s.points));
  s.file.commit();
  s.sha256 = s.hash.hex();
}

std::uint64_t CloudWriter::points() const { return state_->points; }
std::string CloudWriter::points_sha256() const { return state_->sha256; }

}  // namespace gdtslam

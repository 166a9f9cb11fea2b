#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <iterator>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/atomic_file.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/io/sha256.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kPiece = 4096;
constexpr std::size_t kCountDigits = 20;

template <class T>
void append(std::string& bytes, T value) {
  using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
  auto bits = std::bit_cast<Bits>(value);
  for (std::size_t k = 0; k < sizeof(T); ++k, bits >>= 8U) bytes.push_back(static_cast<char>(bits & 0xffU));
}

void append_binary(std::string& bytes, const CloudPoint& point) {
  append(bytes, point.x_m);
  append(bytes, point.y_m);
  append(bytes, point.z_m);
  append(bytes, point.elevation_rad);
  append(bytes, point.stamp_s);
  append(bytes, point.scan);
}

// The shortest digits that read back as the same bits.
void append_text(std::string& text, const CloudPoint& p) {
  fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {}\n", p.x_m, p.y_m, p.z_m, p.elevation_rad, p.stamp_s,
                 p.scan);
}

bool is_ply(CloudFormat format) { return format == CloudFormat::kPlyBinary || format == CloudFormat::kPlyAscii; }
bool is_binary(CloudFormat format) { return format == CloudFormat::kPlyBinary || format == CloudFormat::kPcdBinary; }

// As long for any count: blanks in a comment make up for its missing digits.
std::string header_of(CloudFormat format, std::uint64_t points) {
  const std::string count = std::to_string(points);
  const std::string blanks((kCountDigits - count.size()) * (is_ply(format) ? 1 : 2), ' ');
  if (is_ply(format)) {
    return fmt::format(
        "ply\nformat {} 1.0\ncomment gdtslam; metres, radians, seconds; frame map{}\nelement vertex {}\n"
        "property float x\nproperty float y\nproperty float z\nproperty float elevation\nproperty double time\n"
        "property uint scan\nend_header\n",
        is_binary(format) ? "binary_little_endian" : "ascii", blanks, count);
  }
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\n# gdtslam; metres, radians, seconds; frame map{}\nVERSION 0.7\n"
      "FIELDS x y z elevation time scan\nSIZE 4 4 4 4 8 4\nTYPE F F F F F U\nCOUNT 1 1 1 1 1 1\nWIDTH {}\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA {}\n",
      blanks, count, count, is_binary(format) ? "binary" : "ascii");
}

}  // namespace

CloudFormat cloud_format_of(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
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
  std::string text;
};

CloudWriter::CloudWriter(const std::string& path, CloudFormat format)
    : state_(
          new State{.file = AtomicFile(path), .format = format, .hash = {}, .sha256 = {}, .binary = {}, .text = {}}) {
  state_->file.write(header_of(format, 0));
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
    if (is_binary(s.format)) {
      s.file.write(s.binary);
    } else {
      s.text.clear();
      for (const CloudPoint& point : piece) append_text(s.text, point);
      s.file.write(s.text);
    }
    s.points += piece.size();
  }
}

void CloudWriter::finish() {
  State& s = *state_;
  s.file.rewrite_begin(header_of(s.format, s.points));
  s.file.commit();
  s.sha256 = s.hash.hex();
}

std::uint64_t CloudWriter::points() const { return state_->points; }
std::string CloudWriter::points_sha256() const { return state_->sha256; }

}  // namespace gdtslam

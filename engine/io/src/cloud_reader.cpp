#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "byte_source.hpp"
#include "cloud_input.hpp"
#include "cloud_layout.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/io/decimal.hpp"
#include "lzf.hpp"
#include "pcd_header.hpp"
#include "ply_header.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostPacked = std::size_t{1} << 30U;
constexpr std::size_t kMostExpansion = 300;  // LZF gives at most 264 bytes for three

std::size_t index_of(CloudRole role) { return static_cast<std::size_t>(role); }

bool has(const CloudLayout& layout, CloudRole role) {
  return std::any_of(layout.vertex.columns.begin(), layout.vertex.columns.end(),
                     [role](const CloudColumn& column) { return column.role == role && !column.list_count; });
}

CloudLayout read_header(CloudInput& input) {
  const std::optional<std::string_view> first = input.line();
  if (!first) throw InputError({input.name(), 0}, "is empty");
  CloudLayout layout;
  if (*first == "ply") {
    layout = read_ply_header(input);
  } else if (first->starts_with("# .PCD") || first->starts_with("VERSION")) {
    layout = read_pcd_header(input, std::string(*first));
  } else {
    throw InputError({input.name(), 1}, "is neither PLY nor PCD: the first line says neither 'ply' nor '# .PCD'");
  }
  for (const auto& [role, name] : {std::pair{CloudRole::kX, "x"}, {CloudRole::kY, "y"}, {CloudRole::kZ, "z"}}) {
    if (!has(layout, role)) throw InputError({input.name(), 0}, fmt::format("its points have no column '{}'", name));
  }
  layout.header.points = layout.vertex.count;
  layout.header.has_elevation = has(layout, CloudRole::kElevation);
  layout.header.has_time = has(layout, CloudRole::kTime);
  layout.header.has_scan = has(layout, CloudRole::kScan);
  return layout;
}

bool is_ascii(const CloudLayout& layout) {
  return layout.header.format == CloudFormat::kPlyAscii || layout.header.format == CloudFormat::kPcdAscii;
}

}  // namespace

struct CloudReader::State {
  explicit State(const std::string& path)
      : input(gunzip_if_packed(open_file_source(path), path), path), layout(read_header(input)) {
    for (const CloudElement& element : layout.before) skip(element);
    if (layout.is_compressed) unpack();
  }

  void skip(const CloudElement& element);
  void unpack();
  bool read_point(CloudPoint& point);
  void read_ascii();
  void read_binary();
  void read_unpacked();
  double binary_value(Scalar type);
  void set(const CloudColumn& column, double value) {
    if (column.role != CloudRole::kIgnored) values[index_of(column.role)] = value;
  }
  [[noreturn]] void ends_early() const;
  [[noreturn]] void fail(const std::string& message) const;

  CloudInput input;
  CloudLayout layout;
  std::string unpacked;  // of binary_compressed: column after column
  std::uint64_t done = 0;
  std::uint64_t skipped = 0;
  double values[static_cast<std::size_t>(CloudRole::kIgnored)] = {};
};

void CloudReader::State::ends_early() const {
  throw InputError({input.name(), 0},
                   fmt::format("ends after {} of the {} points that its header names", done, layout.header.points));
}

void CloudReader::State::fail(const std::string& message) const {
  if (is_ascii(layout)) throw InputError({input.name(), input.line_number()}, message);
  throw InputError({input.name(), 0}, fmt::format("point {}: {}", done, message));
}

double CloudReader::State::binary_value(Scalar type) {
  const char* const data = input.bytes(size_of(type));
  if (data == nullptr) ends_early();
  return decode(type, data, layout.is_big_endian);
}

void CloudReader::State::read_binary() {
  for (const CloudColumn& column : layout.vertex.columns) {
    if (column.list_count) {
      const auto count = static_cast<std::int64_t>(binary_value(*column.list_count));
      for (std::int64_t k = 0; k < count; ++k) binary_value(column.type);
    } else {
      for (std::uint64_t k = 0; k < column.repeat; ++k) set(column, binary_value(column.type));
    }
  }
}

void CloudReader::State::read_ascii() {
  std::optional<std::string_view> line = input.line();
  while (line && line->find_first_not_of(" \t") == std::string_view::npos) line = input.line();
  if (!line) ends_early();
  const char* at = line->data();
  const char* const end = at + line->size();
  const auto number = [&] {
    while (at != end && (*at == ' ' || *at == '\t')) ++at;
    double value = 0.0;
    const char* const stop = at == end ? nullptr : parse_double(at, end, value);
    if (stop == nullptr) fail("has fewer numbers than columns, or something that is no number");
    at = stop;
    return value;
  };
  for (const CloudColumn& column : layout.vertex.columns) {
    const double first = column.list_count || column.repeat > 0 ? number() : 0.0;
    if (column.list_count) {
      for (double k = 0.0; k < first; ++k) number();
      continue;
    }
    if (column.repeat > 0) set(column, first);
    for (std::uint64_t k = 1; k < column.repeat; ++k) number();
  }
}

// Elements in front of the vertices: their bytes or lines are read over.
void CloudReader::State::skip(const CloudElement& element) {
  for (std::uint64_t k = 0; k < element.count; ++k) {
    if (is_ascii(layout)) {
      if (!input.line()) ends_early();
      continue;
    }
    for (const CloudColumn& column : element.columns) {
      const double count = column.list_count ? binary_value(*column.list_count) : 1.0;
      for (double item = 0.0; item < count; ++item) binary_value(column.type);
    }
    if (element.columns.empty()) break;  // takes no byte, however many there are
  }
}

// The sizes that the file states are believed only as far as its bytes go.
void CloudReader::State::unpack() {
  const char* const sizes = input.bytes(8);
  if (sizes == nullptr) ends_early();
  const auto packed_size = static_cast<std::size_t>(decode(Scalar::kUint32, sizes, false));
  const auto size = static_cast<std::size_t>(decode(Scalar::kUint32, sizes + 4, false));
  std::uint64_t point_bytes = 0;
  for (const CloudColumn& column : layout.vertex.columns) point_bytes += size_of(column.type) * column.repeat;
  if (packed_size > kMostPacked || size / kMostExpansion > packed_size ||
      (point_bytes > 0 && layout.header.points != size / point_bytes) || layout.header.points * point_bytes != size) {
    throw InputError({input.name(), 0}, "the sizes of its compressed data do not fit its header");
  }
  std::string packed;
  while (packed.size() < packed_size) {
    const std::string_view piece = input.some(packed_size - packed.size());
    if (piece.empty()) throw InputError({input.name(), 0}, "ends within its compressed data");
    packed.append(piece);
  }
  std::optional<std::string> data = unpack_lzf(packed, size);
  if (!data) throw InputError({input.name(), 0}, "its compressed data are damaged");
  unpacked = std::move(*data);
}

void CloudReader::State::read_unpacked() {
  std::uint64_t column_begin = 0;
  for (const CloudColumn& column : layout.vertex.columns) {
    const std::uint64_t bytes = size_of(column.type) * column.repeat;
    if (column.repeat == 1) set(column, decode(column.type, unpacked.data() + column_begin + done * bytes, false));
    column_begin += bytes * layout.header.points;
  }
}

// False when the point is not finite.
bool CloudReader::State::read_point(CloudPoint& point) {
  if (layout.is_compressed) {
    read_unpacked();
  } else if (is_ascii(layout)) {
    read_ascii();
  } else {
    read_binary();
  }
  const auto value = [this](CloudRole role) { return values[index_of(role)]; };
  const double scan = value(CloudRole::kScan);
  if (!(scan >= 0.0 && scan <= std::numeric_limits<std::uint32_t>::max() && scan == std::floor(scan))) {
    fail("its scan number is none from 0 to 4294967295");
  }
  point = {.x_m = static_cast<float>(value(CloudRole::kX)),
           .y_m = static_cast<float>(value(CloudRole::kY)),
           .z_m = static_cast<float>(value(CloudRole::kZ)),
           .elevation_rad = static_cast<float>(value(CloudRole::kElevation)),
           .stamp_s = value(CloudRole::kTime),
           .scan = static_cast<std::uint32_t>(scan)};
  return std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m);
}

CloudReader::CloudReader(const std::string& path) : state_(std::make_unique<State>(path)) {}
CloudReader::~CloudReader() = default;
const CloudHeader& CloudReader::header() const { return state_->layout.header; }
std::uint64_t CloudReader::skipped() const { return state_->skipped; }

Cloud CloudReader::next(std::size_t most) {
  State& s = *state_;
  Cloud cloud;
  CloudPoint point;
  for (; cloud.size() < most && s.done < s.layout.header.points; ++s.done) {
    if (s.read_point(point)) {
      cloud.push_back(point);
    } else {
      ++s.skipped;
    }
  }
  return cloud;
}

Cloud read_cloud(const std::string& path, std::uint64_t max_points) {
  CloudReader reader(path);
  Cloud cloud;
  for (Cloud piece = reader.next(); !piece.empty(); piece = reader.next()) {
    if (cloud.size() + piece.size() > max_points) {
      throw InputError({path, 0},
                       fmt::format("has more than {} points; thin it first (map --set cloud.voxel=...)", max_points));
    }
    cloud.insert(cloud.end(), piece.begin(), piece.end());
  }
  return cloud;
}

}  // namespace gdtslam

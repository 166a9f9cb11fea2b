#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "cloud_file_layout.hpp"
#include "cloud_words.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostPacked = std::size_t{1} << 30U;
constexpr std::size_t kMostExpansion = 88;  // LZF gives at most 264 bytes for three
constexpr std::size_t kMostReserved = 65536;
constexpr auto kRoles = static_cast<std::size_t>(CloudRole::kIgnored);

bool has(const CloudFileLayout& layout, CloudRole role) {
  return std::any_of(layout.vertex.columns.begin(), layout.vertex.columns.end(),
                     [role](const CloudColumn& column) { return column.role == role; });
}

// Checks the columns that every layout must have, in each format.
void check_columns(CloudFileLayout& layout, const std::string& name) {
  std::array<int, kRoles> times{};
  for (CloudColumn& column : layout.vertex.columns) {
    if (column.list_count || column.repeat != 1) column.role = CloudRole::kIgnored;
    if (column.role == CloudRole::kIgnored) continue;
    if (++times[static_cast<std::size_t>(column.role)] > 1) {
      throw InputError({name, 0}, fmt::format("its points have two columns '{}'", to_string(column.role)));
    }
  }
  for (const CloudRole role : {CloudRole::kX, CloudRole::kY, CloudRole::kZ}) {
    if (!has(layout, role)) {
      throw InputError({name, 0}, fmt::format("its points have no column '{}' of one number", to_string(role)));
    }
  }
}

CloudFileLayout read_header(CloudInput& input) {
  const std::optional<std::string_view> first = input.line();
  if (!first) throw InputError({input.name(), 0}, "is empty");
  CloudFileLayout layout;
  if (*first == "ply") {
    layout = read_ply_header(input);
  } else if (first->starts_with("# .PCD") || first->starts_with("VERSION")) {
    layout = read_pcd_header(input, std::string(*first));
  } else {
    throw InputError({input.name(), 1}, "is neither PLY nor PCD: the first line says neither 'ply' nor '# .PCD'");
  }
  check_columns(layout, input.name());
  layout.header.points = layout.vertex.count;
  layout.header.has_elevation = has(layout, CloudRole::kElevation);
  layout.header.has_time = has(layout, CloudRole::kTime);
  layout.header.has_scan = has(layout, CloudRole::kScan);
  return layout;
}

/// A column at the same place in every point.
struct PlacedColumn {
  Scalar type = Scalar::kFloat;
  CloudRole role = CloudRole::kIgnored;
  std::uint64_t offset = 0;  ///< in the point; for compressed data, in the whole data
  std::uint64_t step = 0;    ///< from one point to the next, for compressed data
};

// The columns with a role; empty if lists make points differ in length.
std::vector<PlacedColumn> placed_columns(const CloudFileLayout& layout) {
  std::vector<PlacedColumn> placed;
  std::uint64_t offset = 0;
  for (const CloudColumn& column : layout.vertex.columns) {
    if (column.list_count) return {};
    const std::uint64_t bytes = byte_size(column.type) * column.repeat;
    if (column.role != CloudRole::kIgnored) {
      placed.push_back({column.type, column.role, offset, layout.is_compressed ? bytes : 0});
    }
    offset += layout.is_compressed ? bytes * layout.vertex.count : bytes;
  }
  return placed;
}

// The least number of bytes of a point; lists count only their lengths.
std::uint64_t least_bytes(const CloudFileLayout& layout) {
  std::uint64_t bytes = 0;
  for (const CloudColumn& column : layout.vertex.columns) {
    bytes += column.list_count ? byte_size(*column.list_count) : byte_size(column.type) * column.repeat;
  }
  return bytes;
}

}  // namespace

struct CloudReader::State {
  State(std::unique_ptr<ByteSource> source, const std::string& name)
      : input(gunzip_if_packed(std::move(source), name), name), layout(read_header(input)) {
    for (const CloudElement& element : layout.before) skip(element);
    point_bytes = least_bytes(layout);
    if (layout.is_compressed && layout.vertex.count > 0) unpack();
    if (!layout.is_ascii && (point_bytes <= CloudInput::kMostBytes || layout.is_compressed))
      placed = placed_columns(layout);
  }

  void skip(const CloudElement& element);
  void unpack();
  bool read_point(CloudPoint& point);
  void choose_origin();
  void read_placed();
  void read_row(const CloudElement& element);
  void check_end();
  [[nodiscard]] double value(CloudRole role) const { return values[static_cast<std::size_t>(role)]; }
  void set(const CloudColumn& column, double number) {
    if (column.role != CloudRole::kIgnored) values[static_cast<std::size_t>(column.role)] = number;
  }
  [[noreturn]] void ends_early() const;
  [[noreturn]] void fail(const std::string& message) const;

  CloudInput input;
  CloudFileLayout layout;
  RowValues row{input, layout.is_ascii, layout.is_big_endian};
  std::uint64_t point_bytes = 0;
  std::vector<PlacedColumn> placed;
  std::string unpacked;  // data of binary_compressed, column by column
  std::uint64_t done = 0;
  std::uint64_t skipped = 0;
  bool is_end_checked = false;
  bool is_relative = false;
  bool has_origin = false;
  std::array<double, 3> origin_m{};
  std::array<double, kRoles> values{};  // the current point; columns that the file lacks are 0
};

void CloudReader::State::ends_early() const {
  const std::string defect = input.defect();
  throw InputError({input.name(), 0}, fmt::format("ends after {} of the {} points that its header names{}", done,
                                                  layout.header.points, defect.empty() ? "" : ": " + defect));
}

void CloudReader::State::fail(const std::string& message) const {
  if (layout.is_ascii) throw InputError({input.name(), input.line_number()}, message);
  throw InputError({input.name(), 0}, fmt::format("point {}: {}", done, message));
}

void CloudReader::State::read_row(const CloudElement& element) {
  if (!row.begin_row()) ends_early();
  const std::string_view fault = row.read(element, [&](const CloudColumn& column, double number) {
    if (element.is_vertex && !column.list_count) set(column, number);
  });
  if (fault == RowValues::kEndsEarly) ends_early();
  if (!fault.empty()) fail(std::string(fault));
}

void CloudReader::State::read_placed() {
  const char* const data = layout.is_compressed ? unpacked.data() : input.bytes(point_bytes);
  if (data == nullptr) ends_early();
  for (const PlacedColumn& column : placed) {
    values[static_cast<std::size_t>(column.role)] =
        decode(column.type, data + column.offset + done * column.step, layout.is_big_endian);
  }
}

// Skips the bytes or lines of an element before the vertices.
void CloudReader::State::skip(const CloudElement& element) {
  if (element.columns.empty()) return;  // takes no bytes, for any number of them
  for (std::uint64_t k = 0; k < element.count; ++k) {
    if (!layout.is_ascii) {
      read_row(element);
    } else if (!row.begin_row()) {
      ends_early();
    }
  }
}

// Checks the stated sizes against the bytes of the file.
void CloudReader::State::unpack() {
  const char* const sizes = input.bytes(8);
  if (sizes == nullptr) ends_early();
  const auto packed_size = static_cast<std::size_t>(decode(Scalar::kUint32, sizes, false));
  const auto size = static_cast<std::size_t>(decode(Scalar::kUint32, sizes + 4, false));
  if (packed_size > kMostPacked || size / kMostExpansion > packed_size || layout.vertex.count != size / point_bytes ||
      layout.vertex.count * point_bytes != size) {
    throw InputError({input.name(), 0}, "the sizes of its compressed data do not fit its header");
  }
  std::string packed;
  while (packed.size() < packed_size) {
    const std::string_view piece = input.some(packed_size - packed.size());
    if (piece.empty()) throw InputError({input.name(), 0}, "ends within its compressed data");
    packed.append(piece);
    check_kept_bytes(packed.size(), input.bytes_from_file(), input.name());
  }
  check_kept_bytes(packed.size() + size, input.bytes_from_file(), input.name());
  std::optional<std::string> data = unpack_lzf(packed, size);
  if (!data) throw InputError({input.name(), 0}, "its compressed data are damaged");
  unpacked = std::move(*data);
}

// A file that continues by a point or more has a wrong count, and points would be lost silently.
void CloudReader::State::check_end() {
  if (std::exchange(is_end_checked, true) || layout.has_more || layout.is_compressed) return;
  const bool goes_on = layout.is_ascii
                           ? row.begin_row()
                           : input.bytes(std::min<std::size_t>(point_bytes, CloudInput::kMostBytes)) != nullptr;
  if (goes_on) {
    throw InputError({input.name(), layout.is_ascii ? input.line_number() : 0},
                     fmt::format("goes on after the {} points that its header names; correct the count there", done));
  }
}

// By the first finite point: whole kilometres on the axes on which it is far.
void CloudReader::State::choose_origin() {
  constexpr double kFar_m = 1e4;
  constexpr double kFarthest_m = 1e9;  // no grid of the earth goes beyond
  const std::array<double, 3> first{value(CloudRole::kX), value(CloudRole::kY), value(CloudRole::kZ)};
  for (const double number : first) {
    if (!std::isfinite(number)) return;
  }
  for (std::size_t axis = 0; axis < first.size(); ++axis) {
    const double far = std::abs(first[axis]);
    if (far > kFar_m && far < kFarthest_m) origin_m[axis] = std::floor(first[axis] / 1000.0) * 1000.0;
  }
  has_origin = true;
}

// False if the point is not finite.
bool CloudReader::State::read_point(CloudPoint& point) {
  if (placed.empty()) {
    read_row(layout.vertex);
  } else {
    read_placed();
  }
  if (is_relative && !has_origin) choose_origin();
  point = {.x_m = static_cast<float>(value(CloudRole::kX) - origin_m[0]),
           .y_m = static_cast<float>(value(CloudRole::kY) - origin_m[1]),
           .z_m = static_cast<float>(value(CloudRole::kZ) - origin_m[2]),
           .elevation_rad = static_cast<float>(value(CloudRole::kElevation)),
           .stamp_s = value(CloudRole::kTime)};
  if (!(std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m) &&
        std::isfinite(point.elevation_rad) && std::isfinite(point.stamp_s))) {
    return false;
  }
  const double scan = value(CloudRole::kScan);
  if (!(scan >= 0.0 && scan <= std::numeric_limits<std::uint32_t>::max() && scan == std::floor(scan))) {
    fail("its scan number is none from 0 to 4294967295");
  }
  point.scan = static_cast<std::uint32_t>(scan);
  return true;
}

CloudReader::CloudReader(const std::string& path) : state_(std::make_unique<State>(open_file_source(path), path)) {}
CloudReader::CloudReader(std::span<const std::byte> data, const std::string& name)
    : state_(std::make_unique<State>(open_memory_source(data), name)) {}
CloudReader::~CloudReader() = default;
const CloudHeader& CloudReader::header() const { return state_->layout.header; }
std::uint64_t CloudReader::skipped() const { return state_->skipped; }
void CloudReader::make_relative() { state_->is_relative = true; }
const std::array<double, 3>& CloudReader::origin_m() const { return state_->origin_m; }

void CloudReader::check_kept(std::uint64_t points) const {
  check_kept_bytes(points * sizeof(CloudPoint), state_->input.bytes_from_file(), state_->input.name());
}

Cloud CloudReader::next(std::size_t most) {
  State& s = *state_;
  Cloud cloud;
  cloud.reserve(std::min({most, kMostReserved, static_cast<std::size_t>(s.layout.header.points - s.done)}));
  CloudPoint point;
  for (; cloud.size() < most && s.done < s.layout.header.points; ++s.done) {
    if (s.read_point(point)) {
      cloud.push_back(point);
    } else {
      ++s.skipped;
    }
  }
  if (s.done == s.layout.header.points) s.check_end();
  return cloud;
}

Cloud read_cloud(const std::string& path, std::uint64_t max_points, std::uint64_t* skipped,
                 std::array<double, 3>* origin_m) {
  CloudReader reader(path);
  if (origin_m != nullptr) reader.make_relative();
  Cloud cloud;
  for (Cloud piece = reader.next(); !piece.empty(); piece = reader.next()) {
    reader.check_kept(cloud.size() + piece.size());
    if (cloud.size() + piece.size() > max_points) {
      throw InputError({path, 0},
                       fmt::format("has more than {} points; thin it first (map --set cloud.voxel=...)", max_points));
    }
    cloud.insert(cloud.end(), piece.begin(), piece.end());
  }
  if (skipped != nullptr) *skipped = reader.skipped();
  if (origin_m != nullptr) *origin_m = reader.origin_m();
  return cloud;
}

}  // namespace gdtslam

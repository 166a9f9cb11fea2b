#include "gdtslam/io/map_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/yaml/yaml_file.hpp"
#include "gdtslam/core/error.hpp"
#include "png.hpp"

namespace gdtslam {
namespace {

// Levels and thresholds of map_server. With 0.196, (255 - 205) / 255 = 0.19608 stays unknown; with Nav2's default of
// 0.25 for files that state none it would be free, so the thresholds are always written.
constexpr std::uint8_t kOccupiedLevel = 0;
constexpr std::uint8_t kFreeLevel = 254;
constexpr std::uint8_t kUnknownLevel = 205;
constexpr double kOccupiedThreshold = 0.65;
constexpr double kFreeThreshold = 0.196;

std::uint8_t to_level(CellState state) {
  switch (state) {
    case CellState::kFree:
      return kFreeLevel;
    case CellState::kOccupied:
      return kOccupiedLevel;
    case CellState::kUnknown:
      break;
  }
  return kUnknownLevel;
}

// Writes rows from the top; the map is not copied.
template <class Take>
void for_each_row(const OccupancyMap& map, const Take& take) {
  const auto width = static_cast<std::size_t>(map.geometry.width);
  std::vector<CellState> row(width);
  std::vector<std::uint8_t> levels(width);
  for (std::int32_t y = map.geometry.height; y-- > 0;) {
    map.read_row(y, row);
    std::transform(row.begin(), row.end(), levels.begin(), to_level);
    take(std::as_bytes(std::span(levels)));
  }
}

void write_image(AtomicFile& file, const OccupancyMap& map, MapImage image) {
  const auto width = static_cast<std::uint32_t>(map.geometry.width);
  const auto height = static_cast<std::uint32_t>(map.geometry.height);
  const auto write = [&file](std::span<const std::byte> bytes) { file.write(bytes); };
  if (image == MapImage::kPgm) {
    file.write(fmt::format("P5\n{} {}\n255\n", width, height));
    return for_each_row(map, write);
  }
  PngWriter png(width, height, PngWriter::Pixels::kGrey8, write);
  for_each_row(map, [&png](std::span<const std::byte> row) { png.add_row(row); });
  png.finish();
}

// A PGM or a PNG, plain or gzip, by the first bytes of the file, because names may be wrong.
Grey8Image read_image(const std::string& path) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 30U;
  constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 30U;
  const std::string text = read_all(*gunzip_if_packed(open_file_source(path), path), kMostBytes, path);
  const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
  return text.starts_with(kPngMagic) ? decode_png_grey8(bytes, path, kMostPixels) : decode_pgm(bytes, path);
}

struct Thresholds {
  double occupied = kOccupiedThreshold;
  double free = kFreeThreshold;
  bool negate = false;
};

Thresholds read_thresholds(const DescriptionFile& file) {
  Thresholds thresholds;
  thresholds.occupied = file.number_or("occupied_thresh", kOccupiedThreshold);
  thresholds.free = file.number_or("free_thresh", kFreeThreshold);
  // A number, or a word as in Nav2.
  const std::string negate = file.has("negate") ? file.text("negate") : "0";
  thresholds.negate = negate == "true" || (negate != "false" && file.number_or("negate", 0.0) != 0.0);
  for (const char* key : {"occupied_thresh", "free_thresh"}) {
    const double value = file.number_or(key, 0.5);
    if (value < 0.0 || value > 1.0) {
      file.fail(key, fmt::format("{} is outside [0, 1]", value));
    }
  }
  if (thresholds.free > thresholds.occupied) {
    file.fail("free_thresh", "is above occupied_thresh");
  }
  if (file.has("mode") && file.text("mode") != "trinary" && file.text("mode") != "scale") {
    file.fail("mode", "only trinary and scale are read");
  }
  return thresholds;
}

CellState decode_state(std::uint8_t level, std::uint32_t max_value, const Thresholds& thresholds) {
  const double brightness = static_cast<double>(level) / static_cast<double>(max_value);
  const double occupancy = thresholds.negate ? brightness : 1.0 - brightness;
  if (occupancy > thresholds.occupied) {
    return CellState::kOccupied;
  }
  return occupancy < thresholds.free ? CellState::kFree : CellState::kUnknown;
}

}  // namespace

void write_occupancy_map(const std::string& yaml_path, const OccupancyMap& map, MapImage image) {
  const char* const extension = image == MapImage::kPgm ? ".pgm" : ".png";
  const std::filesystem::path image_path = std::filesystem::path(yaml_path).replace_extension(extension);
  AtomicFileSet files;
  write_image(files.add(image_path.string()), map, image);
  files.add(yaml_path).write(fmt::format(
      "image: {}\nmode: trinary\nresolution: {}\norigin: [{}, {}, 0.0]\nnegate: 0\n"
      "occupied_thresh: {}\nfree_thresh: {}\n",
      image_path.filename().string(), yaml_number(map.geometry.resolution_m), yaml_number(map.geometry.origin_x_m),
      yaml_number(map.geometry.origin_y_m), yaml_number(kOccupiedThreshold), yaml_number(kFreeThreshold)));
  files.commit();
}

OccupancyMap read_occupancy_map(const std::string& yaml_path) {
  const DescriptionFile file(yaml_path);
  OccupancyMap map;
  map.geometry = file.geometry();
  const Thresholds thresholds = read_thresholds(file);
  const Grey8Image image = read_image(file.image_path());
  map.geometry.width = static_cast<std::int32_t>(image.width);
  map.geometry.height = static_cast<std::int32_t>(image.height);
  map.cells = CellStates(image.pixels.size());
  std::size_t cell = 0;
  for (std::size_t rows = image.height; rows > 0; --rows) {
    const std::size_t begin = (rows - 1) * image.width;
    for (std::uint32_t x = 0; x < image.width; ++x, ++cell) {
      map.cells.set(cell, decode_state(image.pixels[begin + x], image.max_value, thresholds));
    }
  }
  return map;
}

}  // namespace gdtslam

#include "gdtslam/io/map_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>

#include "engine/io/atomic_file.hpp"
#include "engine/io/yaml/yaml_file.hpp"
#include "gdtslam/core/error.hpp"
#include "png.hpp"

namespace gdtslam {
namespace {

constexpr int kFieldVersion = 2;
constexpr double kUnitsPerCell = 256.0;
constexpr int kMaxLevel = 65535;

/// Grey levels per unit of 1/256 cell, the most that the picture can hold, because levels up to the cap would be near
/// black.
int levels_per_unit(std::uint16_t cap) { return kMaxLevel / int{cap}; }

void check_writable(const std::string& yaml_path, const DistanceFieldRows& field) {
  if (field.geometry.width <= 0 || field.geometry.height <= 0) {
    throw InputError({yaml_path, 0},
                     fmt::format("a distance field of {} x {} cells cannot be written; map at least one "
                                 "scan first",
                                 field.geometry.width, field.geometry.height));
  }
  if (field.cap == 0) {
    throw InputError({yaml_path, 0}, "a distance field whose cap is 0 tells no distance and cannot be written");
  }
}

// Writes rows from the top; the field is not copied.
void write_image(AtomicFile& file, const std::string& yaml_path, const DistanceFieldRows& field) {
  const int scale = levels_per_unit(field.cap);
  const auto width = static_cast<std::size_t>(field.geometry.width);
  PngWriter png(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(field.geometry.height),
                PngWriter::Pixels::kGrey16, [&file](std::span<const std::byte> bytes) { file.write(bytes); });
  std::vector<std::uint16_t> row(width);
  for (std::int32_t y = field.geometry.height; y-- > 0;) {
    field.read(y, row);
    if (const std::uint16_t largest = *std::max_element(row.begin(), row.end()); largest > field.cap) {
      throw InputError({yaml_path, 0}, fmt::format("the distance {} in row {} lies above the field's cap of {}",
                                                   largest, y, field.cap));
    }
    for (std::uint16_t& value : row) value = static_cast<std::uint16_t>(value * scale);
    png.add_row(std::as_bytes(std::span(row)));
  }
  png.finish();
}

std::string describe(const DistanceFieldRows& field, const std::string& image) {
  const GridGeometry& geometry = field.geometry;
  const int scale = levels_per_unit(field.cap);
  return fmt::format(
      "version: {}\nimage: {}\nresolution: {}  # m per pixel\norigin: [{}, {}, 0.0]  # m, lower left corner\n"
      "unit: {}  # m per grey level, resolution/256/scale\nscale: {}  # grey levels per 1/256 cell\n"
      "cap: {}  # level that means this far or farther, or unknown\n",
      kFieldVersion, image, yaml_number(geometry.resolution_m), yaml_number(geometry.origin_x_m),
      yaml_number(geometry.origin_y_m), yaml_number(geometry.resolution_m / kUnitsPerCell / scale), scale,
      scale * field.cap);
}

int whole_level(const DescriptionFile& file, const char* key) {
  const double value = file.number(key);
  if (!(value >= 1.0 && value <= kMaxLevel) || value != static_cast<double>(static_cast<int>(value))) {
    file.fail(key, fmt::format("must be a whole number from 1 to {}", kMaxLevel));
  }
  return static_cast<int>(value);
}

/// The statements of the description about levels.
struct Levels {
  int scale = 1;  ///< per 1/256 cell
  int cap = 1;
};
Levels read_levels(const DescriptionFile& file, double resolution_m) {
  const double version = file.number("version");
  if (version != 1.0 && version != kFieldVersion) {
    file.fail("version", fmt::format("only versions 1 and {} are read", kFieldVersion));
  }
  // Version 1 had no scale: a level was 1/256 cell.
  const Levels levels{version == 1.0 ? 1 : whole_level(file, "scale"), whole_level(file, "cap")};
  if (levels.cap % levels.scale != 0) {
    file.fail("cap", fmt::format("{} is no multiple of the scale {}", levels.cap, levels.scale));
  }
  const double unit_m = resolution_m / kUnitsPerCell / levels.scale;
  constexpr double kTolerance = 1e-9;  // a unit rounded by another program
  if (std::fabs(file.number("unit") - unit_m) > kTolerance * unit_m) {
    file.fail("unit", fmt::format("must be {}, resolution/256/scale", yaml_number(unit_m)));
  }
  return levels;
}

std::uint16_t decode_level(std::uint16_t level, const Levels& levels, const std::string& image_path) {
  if (level % levels.scale != 0 || level > levels.cap) {
    throw InputError(
        {image_path, 0},
        fmt::format("holds the level {}, which is {}; the picture and its description do not belong together "
                    "or the picture was changed",
                    level,
                    level > levels.cap ? fmt::format("above the cap {}", levels.cap)
                                       : fmt::format("no multiple of the scale {}", levels.scale)));
  }
  return static_cast<std::uint16_t>(level / levels.scale);
}

}  // namespace

void write_distance_field(const std::string& yaml_path, const DistanceFieldRows& field) {
  check_writable(yaml_path, field);
  const std::filesystem::path image_path = std::filesystem::path(yaml_path).replace_extension(".png");
  AtomicFileSet files;
  write_image(files.add(image_path.string()), yaml_path, field);
  files.add(yaml_path).write(describe(field, image_path.filename().string()));
  files.commit();
}

DistanceFieldFile read_distance_field(const std::string& yaml_path) {
  const DescriptionFile file(yaml_path);
  DistanceFieldFile field;
  field.geometry = file.geometry();
  const Levels levels = read_levels(file, field.geometry.resolution_m);
  field.cap = static_cast<std::uint16_t>(levels.cap / levels.scale);
  const std::string image_path = file.image_path();
  const Grey16Image image = read_png_grey16(image_path);
  field.geometry.width = static_cast<std::int32_t>(image.width);
  field.geometry.height = static_cast<std::int32_t>(image.height);
  field.cells.reserve(image.pixels.size());
  for (std::size_t rows = image.height; rows > 0; --rows) {
    const auto pixels = std::span(image.pixels).subspan((rows - 1) * image.width, image.width);
    for (const std::uint16_t level : pixels) field.cells.push_back(decode_level(level, levels, image_path));
  }
  return field;
}

}  // namespace gdtslam

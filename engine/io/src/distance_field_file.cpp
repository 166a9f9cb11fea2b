#include "gdtslam/io/distance_field_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/atomic_file.hpp"
#include "gdtslam/io/png.hpp"
#include "yaml_file.hpp"

namespace gdtslam {
namespace {

constexpr int kVersion = 1;
constexpr double kLevelsPerCell = 256.0;

std::vector<std::uint16_t> rows_from_top(const DistanceFieldView& field) {
  std::vector<std::uint16_t> pixels;
  pixels.reserve(field.geometry.cell_count());
  const auto width = static_cast<std::size_t>(field.geometry.width);
  for (auto y = static_cast<std::size_t>(field.geometry.height); y-- > 0;) {
    const auto row = field.cells.subspan(y * field.stride, width);
    pixels.insert(pixels.end(), row.begin(), row.end());
  }
  return pixels;
}

std::string description_of(const DistanceFieldView& field, const std::string& image) {
  const GridGeometry& geometry = field.geometry;
  return fmt::format(
      "version: {}\nimage: {}\nresolution: {}  # m per pixel\norigin: [{}, {}, 0.0]  # m, lower left corner\n"
      "unit: {}  # m per grey level, 1/256 cell\ncap: {}  # level that means this far or farther, or unknown\n",
      kVersion, image, yaml_number(geometry.resolution_m), yaml_number(geometry.origin_x_m),
      yaml_number(geometry.origin_y_m), yaml_number(geometry.resolution_m / kLevelsPerCell), field.cap);
}

}  // namespace

DistanceFieldView view_of(const GlobalField& field) {
  return {field.geometry(), field.stride(), field.cells(), field.cap()};
}

void write_distance_field(const std::string& yaml_path, const DistanceFieldView& field) {
  const std::filesystem::path image_path = std::filesystem::path(yaml_path).replace_extension(".png");
  const std::vector<std::uint16_t> pixels = rows_from_top(field);
  const std::string png =
      encode_png({static_cast<std::uint32_t>(field.geometry.width), static_cast<std::uint32_t>(field.geometry.height),
                  PixelFormat::kGrey16, std::as_bytes(std::span(pixels))});
  AtomicFileSet files;
  files.add(image_path.string()).write(png);
  files.add(yaml_path).write(description_of(field, image_path.filename().string()));
  files.commit();
}

DistanceFieldFile read_distance_field(const std::string& yaml_path) {
  const DescriptionFile file(yaml_path);
  if (file.number("version") != kVersion) {
    file.fail("version", fmt::format("only version {} is read", kVersion));
  }
  DistanceFieldFile field;
  field.geometry.resolution_m = file.resolution_m();
  const DescriptionFile::Origin origin = file.origin();
  field.geometry.origin_x_m = origin.x_m;
  field.geometry.origin_y_m = origin.y_m;
  const double cap = file.number("cap");
  if (cap < 1.0 || cap > 65535.0 || cap != static_cast<double>(static_cast<std::uint16_t>(cap))) {
    file.fail("cap", "must be a whole number from 1 to 65535");
  }
  field.cap = static_cast<std::uint16_t>(cap);
  const Grey16Image image = read_png_grey16(file.image_path());
  field.geometry.width = static_cast<std::int32_t>(image.width);
  field.geometry.height = static_cast<std::int32_t>(image.height);
  field.cells.reserve(image.pixels.size());
  for (std::uint32_t row = image.height; row-- > 0;) {
    const auto begin = image.pixels.begin() + static_cast<std::ptrdiff_t>(std::size_t{row} * image.width);
    field.cells.insert(field.cells.end(), begin, begin + static_cast<std::ptrdiff_t>(image.width));
  }
  return field;
}

}  // namespace gdtslam

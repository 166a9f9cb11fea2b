// Maps as files: a YAML beside a picture whose top row has the highest y (docs/formats.md). Occupancy maps are in the
// format of ROS map_server and Nav2: map.pgm (0 occupied, 254 free, 205 unknown) and map.yaml with full precision. The
// GDT is a picture that keeps every bit: gdt.png (16-bit grey) with gdt.yaml. Its values are in 1/256 cell; the cap
// means "this far or farther, or unknown". A grey level is the value times the largest whole scale that fits, so that
// people can see the picture. Thread-safe; O(cells).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gdtslam/core/grids.hpp"

namespace gdtslam {

/// Plain or packed pixels: a packed map, mostly unknown, takes a hundredth.
enum class MapImage : std::uint8_t { kPgm, kPng };

/// Writes the YAML at `yaml_path` and the image beside it (the same stem), the YAML last. Throws FileError.
void write_occupancy_map(const std::string& yaml_path, const OccupancyMap& map, MapImage image = MapImage::kPgm);

/// Modes trinary and scale; a PGM or a PNG; colours count by their mean, transparency is ignored. The image must lie in
/// or below the folder of the YAML. Throws InputError or FileError.
OccupancyMap read_occupancy_map(const std::string& yaml_path);

/// Writes the YAML at `yaml_path` and the PNG beside it (the same stem), the YAML last. Throws FileError;
/// InputError when the field has no cells, its cap is 0 or a value lies above the cap.
void write_distance_field(const std::string& yaml_path, const DistanceFieldRows& field);

/// A distance field read from a file; stride = width.
struct DistanceFieldFile {
  GridGeometry geometry;
  std::vector<std::uint16_t> cells;
  std::uint16_t cap = 0;
  [[nodiscard]] DistanceFieldView view() const {
    return {geometry, static_cast<std::size_t>(geometry.width), cells, cap};
  }
};
/// Throws InputError or FileError.
DistanceFieldFile read_distance_field(const std::string& yaml_path);

}  // namespace gdtslam

// Occupancy maps as ROS map_server and Nav2 read them: map.pgm (0 occupied, 254 free, 205 unknown; top row = highest y)
// and map.yaml with full precision (docs/formats.md). Thread-safe; O(cells).
#pragma once

#include <cstdint>
#include <string>

#include "gdtslam/core/grids.hpp"

namespace gdtslam {

/// Pixels as they are, or packed: mostly unknown as it is, a map then takes a hundredth.
enum class MapImage : std::uint8_t { kPgm, kPng };

/// Writes the YAML at `yaml_path` and the image beside it (the same stem), the YAML last. Throws FileError.
void write_occupancy_map(const std::string& yaml_path, const OccupancyMap& map, MapImage image = MapImage::kPgm);

/// Modes trinary and scale; a PGM or a PNG, of which colours count by their mean and transparency does not. The image
/// must lie in or below the folder of the YAML. Throws InputError or FileError.
OccupancyMap read_occupancy_map(const std::string& yaml_path);

}  // namespace gdtslam

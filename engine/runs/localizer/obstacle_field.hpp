// The distance field of any occupancy map: the exact distance from each cell to the nearest occupied one, paper
// equation (1). Unknown cells are no obstacles. Frame: the map's. Thread-safe; O(cells of the field times the radius);
// memory for the field and some rows.
#pragma once

#include <cstdint>

#include "gdtslam/io/map_files.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// The radius of such a field in cells, for a truncation in metres: at least four cells, because two already count as a
/// good fit, and at most the transform's limit of 255.
std::uint32_t obstacle_radius(double truncation_m, double resolution_m);

/// A larger field is refused, as in the picture of a field.
inline constexpr std::uint64_t kMostObstacleFieldCells = std::uint64_t{1} << 29U;

/// The size of the field of obstacle_field(); 0 by 0 if no cell is occupied. Throws InputError, as it does.
struct ObstacleFieldSize {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
};
ObstacleFieldSize obstacle_field_size(const OccupancyMap& map, std::uint32_t radius_cells);

/// Rows that are transformed at once; the field does not depend on it.
inline constexpr std::int32_t kObstacleFieldBand = 256;

/// Distances up to `radius_cells`, 1 to 255, on the map's cells around the occupied ones; the two outermost rows and
/// columns hold the cap. No cells if none is occupied. Throws InputError, without a file, if there would be too many.
DistanceFieldFile obstacle_field(const OccupancyMap& map, std::uint32_t radius_cells,
                                 std::int32_t band_rows = kObstacleFieldBand);

}  // namespace gdtslam

// The distance field of an occupancy map, whoever made it: the exact distance from each cell to the nearest occupied
// one, paper equation (1). Cells of which nothing is known are no obstacles. Frame: the map's. Thread-safe; O(cells of
// the field times the radius), within its memory and some rows.
#pragma once

#include <cstdint>

#include "gdtslam/io/map_files.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// The radius of such a field in cells, for a truncation in metres: at least four cells, for two already count as a
/// good fit, and at most the 255 that the transform can tell.
std::uint32_t obstacle_radius(double truncation_m, double resolution_m);

/// More cells than this are refused, as in the picture of a field.
inline constexpr std::uint64_t kMostObstacleFieldCells = std::uint64_t{1} << 29U;

/// The size that obstacle_field() would have; 0 by 0 where no cell is occupied. Throws InputError, as it does.
struct ObstacleFieldSize {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
};
ObstacleFieldSize obstacle_field_size(const OccupancyMap& map, std::uint32_t radius_cells);

/// Rows that are transformed at once; the field does not depend on it.
inline constexpr std::int32_t kObstacleFieldBand = 256;

/// Distances up to `radius_cells`, 1 to 255, on the map's cells, as far around the occupied ones as there are any: the
/// two outermost rows and columns hold the cap. No cells where none is occupied. Throws InputError, without a file,
/// where there would be too many.
DistanceFieldFile obstacle_field(const OccupancyMap& map, std::uint32_t radius_cells,
                                 std::int32_t band_rows = kObstacleFieldBand);

}  // namespace gdtslam

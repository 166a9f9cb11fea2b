#include "gdtslam/core/grid_geometry.hpp"

#include <cmath>
#include <limits>

namespace gdtslam {
namespace {

// Written so that NaN fails the first test and ends at the lower limit, outside of every grid.
std::int32_t clamp_to_int32(double floored) {
  constexpr double kLowest = std::numeric_limits<std::int32_t>::min();
  constexpr double kHighest = std::numeric_limits<std::int32_t>::max();
  if (!(floored > kLowest)) {
    return std::numeric_limits<std::int32_t>::min();
  }
  if (floored > kHighest) {
    return std::numeric_limits<std::int32_t>::max();
  }
  return static_cast<std::int32_t>(floored);
}

}  // namespace

CellIndex GridGeometry::cell_at(const Eigen::Vector2d& point_m) const {
  return {clamp_to_int32(std::floor((point_m.x() - origin_x_m) / resolution_m)),
          clamp_to_int32(std::floor((point_m.y() - origin_y_m) / resolution_m))};
}

Eigen::Vector2d GridGeometry::cell_centre(CellIndex cell) const {
  return {origin_x_m + (static_cast<double>(cell.x) + 0.5) * resolution_m,
          origin_y_m + (static_cast<double>(cell.y) + 0.5) * resolution_m};
}

}  // namespace gdtslam

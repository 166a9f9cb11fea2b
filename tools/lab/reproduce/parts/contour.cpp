#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "tools/lab/reproduce/paper.hpp"

namespace gdtslam::reproduce {
namespace {

using Cell = std::pair<std::int32_t, std::int32_t>;  // y before x, as the rows of a map lie

// Of the cells, those with one of the others within the reach; the others are sorted.
double share_near(const std::vector<Cell>& cells, const std::vector<Cell>& others, std::int32_t reach) {
  std::size_t near = 0;
  for (const auto& [y, x] : cells) {
    bool is_near = false;
    for (std::int32_t v = y - reach; v <= y + reach && !is_near; ++v) {
      const auto first = std::lower_bound(others.begin(), others.end(), Cell{v, x - reach});
      is_near = first != others.end() && *first <= Cell{v, x + reach};
    }
    near += is_near ? 1U : 0U;
  }
  return cells.empty() ? 0.0 : static_cast<double>(near) / static_cast<double>(cells.size());
}

/// The points of scans raised by more than 2 degrees: those of level scans are the 2D map over again.
std::vector<std::pair<Cell, float>> raised_points(const GridGeometry& grid, std::span<const CloudPoint> cloud) {
  constexpr float kRaised_rad = 0.035F;
  std::vector<std::pair<Cell, float>> raised;
  for (const CloudPoint& point : cloud) {
    if (std::fabs(point.elevation_rad) < kRaised_rad) continue;
    const CellIndex cell = grid.cell_of({static_cast<double>(point.x_m), static_cast<double>(point.y_m)});
    raised.push_back({{cell.y, cell.x}, point.z_m});
  }
  std::sort(raised.begin(), raised.end());  // by cell, then by height
  return raised;
}

}  // namespace

ContourShares contour_shares(const OccupancyMap& map, std::span<const CloudPoint> cloud,
                             std::span<const Point2> truth) {
  constexpr double kNear_m = 0.05;
  constexpr float kWall_m = 1.0F;  // lintels and furniture span less
  std::vector<Cell> seen;
  std::vector<Cell> walls;
  const std::vector<std::pair<Cell, float>> raised = raised_points(map.geometry, cloud);
  for (auto first = raised.begin(); first != raised.end();) {
    const auto end =
        std::find_if(first, raised.end(), [first](const auto& other) { return other.first != first->first; });
    seen.push_back(first->first);
    if (std::prev(end)->second - first->second >= kWall_m) walls.push_back(first->first);
    first = end;
  }
  std::vector<Cell> occupied;
  for (std::size_t k = 0; k < map.cells.size(); ++k) {
    const auto width = static_cast<std::size_t>(map.geometry.width);
    if (map.cells[k] != CellState::kOccupied) continue;
    occupied.emplace_back(static_cast<std::int32_t>(k / width), static_cast<std::int32_t>(k % width));
  }
  const auto reach = static_cast<std::int32_t>(std::ceil(kNear_m / map.geometry.resolution_m));
  std::vector<Cell> surfaces;
  for (const Point2& point : truth) {
    const CellIndex cell = map.geometry.cell_of(point);
    surfaces.emplace_back(cell.y, cell.x);
  }
  std::sort(surfaces.begin(), surfaces.end());
  surfaces.erase(std::unique(surfaces.begin(), surfaces.end()), surfaces.end());
  return {share_near(occupied, seen, reach), share_near(walls, occupied, reach), share_near(surfaces, seen, reach)};
}

}  // namespace gdtslam::reproduce

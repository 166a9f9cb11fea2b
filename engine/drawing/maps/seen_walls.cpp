#include "seen_walls.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::picture {
namespace {

/// The robot itself stands in no wall, whatever the map says of the cells around it.
constexpr double kOwnPlace_m = 0.25;
constexpr double kStepsPerCell = 8.0;  ///< along a beam: a corner that is cut by less hides nothing

std::optional<CellIndex> wall_along(const OccupancyMap& map, const Point2& from_m, const Point2& direction,
                                    double reach_m) {
  const double step_m = map.geometry.resolution_m / kStepsPerCell;
  for (double at_m = kOwnPlace_m; at_m <= reach_m; at_m += step_m) {
    const CellIndex cell = map.geometry.cell_at(from_m + at_m * direction);
    if (!map.geometry.contains(cell)) return std::nullopt;
    const CellState state = map.at(cell);
    if (state != CellState::kFree) return state == CellState::kOccupied ? std::optional(cell) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Point2> walls_seen_from(const OccupancyMap& map, const Pose2& T_map_pose, double reach_m, int beams) {
  std::vector<CellIndex> cells;
  const Point2 from_m = T_map_pose.translation();
  if (!T_map_pose.is_finite() || !map.geometry.contains(map.geometry.cell_at(from_m))) return {};
  for (int k = 0; k < beams; ++k) {
    const SinCos<double> turn = sin_cos(2.0 * kPi * k / beams);
    const std::optional<CellIndex> wall = wall_along(map, from_m, {turn.cos, turn.sin}, reach_m);
    if (wall) cells.push_back(*wall);
  }
  const auto is_before = [](CellIndex a, CellIndex b) { return a.y != b.y ? a.y < b.y : a.x < b.x; };
  std::sort(cells.begin(), cells.end(), is_before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const Pose2 T_pose_map = inverse(T_map_pose);
  std::vector<Point2> walls;
  walls.reserve(cells.size());
  for (const CellIndex cell : cells) walls.push_back(T_pose_map * map.geometry.cell_centre(cell));
  return walls;
}

}  // namespace gdtslam::picture

#include "seen_walls.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::picture {
namespace {

/// A beam through cells, border by border [AmanatidesWoo1987].
class CellWalk {
 public:
  CellWalk(const GridGeometry& grid, const Point2& from_m, const Point2& direction)
      : cell_(grid.cell_of(from_m)),
        x_(from_m.x() - grid.origin_x_m, cell_.x, direction.x(), grid.resolution_m),
        y_(from_m.y() - grid.origin_y_m, cell_.y, direction.y(), grid.resolution_m) {}

  [[nodiscard]] CellIndex cell() const { return cell_; }
  /// Into the next cell; returns how far along the beam its border is, metres.
  double step() {
    Axis& axis = x_.next_m <= y_.next_m ? x_ : y_;
    (x_.next_m <= y_.next_m ? cell_.x : cell_.y) += axis.sign;
    const double at_m = axis.next_m;
    axis.next_m += axis.every_m;
    return at_m;
  }

 private:
  struct Axis {
    Axis(double at_m, std::int32_t cell, double direction, double cell_m)
        : sign(direction < 0.0 ? -1 : 1),
          every_m(direction == 0.0 ? HUGE_VAL : cell_m / std::fabs(direction)),
          next_m(direction == 0.0 ? HUGE_VAL : ((cell + (sign > 0 ? 1 : 0)) * cell_m - at_m) / direction) {}
    std::int32_t sign;
    double every_m;
    double next_m;
  };
  CellIndex cell_;
  Axis x_;
  Axis y_;
};

/// The robot itself stands in no wall, whatever the map says of the cells around it.
constexpr double kOwnPlace_m = 0.25;

std::optional<CellIndex> wall_along(const OccupancyMap& map, const Point2& from_m, const Point2& direction,
                                    double reach_m) {
  CellWalk walk(map.geometry, from_m, direction);
  for (double at_m = 0.0; at_m <= reach_m; at_m = walk.step()) {
    if (!map.geometry.contains(walk.cell())) return std::nullopt;
    const CellState state = map.at(walk.cell());
    if (at_m < kOwnPlace_m || state == CellState::kFree) continue;
    return state == CellState::kOccupied ? std::optional(walk.cell()) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Point2> walls_seen_from(const OccupancyMap& map, const Pose2& T_map_pose, double reach_m, int beams) {
  std::vector<CellIndex> cells;
  const Point2 from_m = T_map_pose.translation();
  if (!T_map_pose.is_finite() || !map.geometry.contains(map.geometry.cell_of(from_m))) return {};
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
  for (const CellIndex cell : cells) walls.push_back(T_pose_map * map.geometry.centre_of(cell));
  return walls;
}

}  // namespace gdtslam::picture

// Scans cast in the cells of occupancy maps, and a building to cast them in. Brute force: small steps along each beam.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam::test {

inline constexpr double kReach_m = 30.0;

inline bool is_occupied(const OccupancyMap& map, double x_m, double y_m) {
  const CellIndex cell = map.geometry.cell_at({x_m, y_m});
  return map.geometry.contains(cell) && map.at(cell) == CellState::kOccupied;
}

// In small steps to the first occupied cell; what is unknown stops no beam.
inline double cast(const OccupancyMap& map, const Pose2& from, double bearing_rad) {
  const double step_m = map.geometry.resolution_m / 50.0;
  const double dx = std::cos(from.theta_rad + bearing_rad);
  const double dy = std::sin(from.theta_rad + bearing_rad);
  for (double range_m = 0.0; range_m < kReach_m; range_m += step_m) {
    if (is_occupied(map, from.x_m + range_m * dx, from.y_m + range_m * dy)) return range_m;
  }
  return kReach_m;
}

inline LaserScan scan_at(const OccupancyMap& map, const Pose2& T_map_base, Random& random) {
  LaserScan scan;
  scan.bearing_step_rad = rad_from_deg(1.0);
  scan.first_bearing_rad = rad_from_deg(-180.0);
  scan.max_range_m = kReach_m;
  for (int beam = 0; beam < 360; ++beam) {
    const double range_m = cast(map, T_map_base, scan.first_bearing_rad + beam * scan.bearing_step_rad);
    scan.ranges_m.push_back(static_cast<float>(range_m < kReach_m ? range_m + random.normal(0.0, 0.01) : kReach_m));
  }
  return scan;
}

// In a free cell, with a robot's room around it.
inline Pose2 free_pose(const OccupancyMap& map, Random& random) {
  constexpr double kRoom_m = 0.4;
  const GridGeometry& grid = map.geometry;
  for (;;) {
    const Pose2 pose{grid.origin_x_m + random.uniform(0.0, grid.resolution_m * grid.width),
                     grid.origin_y_m + random.uniform(0.0, grid.resolution_m * grid.height),
                     random.uniform(-3.14, 3.14)};
    bool is_free = true;
    for (double dx = -kRoom_m; dx <= kRoom_m; dx += grid.resolution_m) {
      for (double dy = -kRoom_m; dy <= kRoom_m; dy += grid.resolution_m) {
        const CellIndex cell = grid.cell_at({pose.x_m + dx, pose.y_m + dy});
        is_free = is_free && grid.contains(cell) && map.at(cell) == CellState::kFree;
      }
    }
    if (is_free) return pose;
  }
}

inline void fill(OccupancyMap& map, CellBox box, CellState state) {
  for (std::int32_t y = box.min.y; y < box.end.y; ++y) {
    for (std::int32_t x = box.min.x; x < box.end.x; ++x) {
      map.cells.set(
          static_cast<std::size_t>(y) * static_cast<std::size_t>(map.geometry.width) + static_cast<std::size_t>(x),
          state);
    }
  }
}

// Three rooms of different sizes and a corridor, of cells of 5 cm. The origin lies between cells and far away, as
// surveyors' coordinates do.
inline OccupancyMap drawn_building() {
  OccupancyMap map;
  map.geometry = {0.05, -7.013, 5'400'000.017, 320, 240};
  map.cells = CellStates(map.geometry.cell_count());
  const auto room = [&map](CellIndex min, CellIndex end) {
    fill(map, {{min.x - 1, min.y - 1}, {end.x + 1, end.y + 1}}, CellState::kOccupied);
    fill(map, {min, end}, CellState::kFree);
  };
  room({20, 20}, {120, 90});
  room({121, 20}, {230, 70});
  room({231, 20}, {300, 120});
  room({20, 121}, {300, 150});
  for (const CellBox door : {CellBox{{120, 40}, {121, 58}}, {{230, 30}, {231, 48}}, {{250, 120}, {270, 121}}}) {
    fill(map, door, CellState::kFree);
  }
  fill(map, {{60, 70}, {75, 78}}, CellState::kOccupied);
  fill(map, {{180, 50}, {186, 56}}, CellState::kOccupied);
  return map;
}

}  // namespace gdtslam::test

#include "map_region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "engine/mapping/map/scan_beams.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

bool is_taken_out(const EndRules& rules, const Point2& end_m) {
  const auto has_it = [&end_m](const MapRegion& region) { return region.contains(end_m); };
  return std::any_of(rules.erased.begin(), rules.erased.end(), has_it) ||
         !std::all_of(rules.kept.begin(), rules.kept.end(), has_it);
}

// The first cell of a row or a column whose centre is not below the coordinate.
CellIndex first_cell_from(const GridGeometry& map, const Point2& low_m) {
  constexpr double kShareBelowCentre = 0.5 - 1.0e-6;  // a centre on the coordinate counts, whatever rounding says
  const double up_m = kShareBelowCentre * map.resolution_m;
  return map.cell_at({low_m.x() + up_m, low_m.y() + up_m});
}

// The cells of the map whose centres may lie in all of the regions.
CellBox cells_within(const GridGeometry& map, const std::vector<MapRegion>& kept) {
  CellBox box{{0, 0}, {map.width, map.height}};
  for (const MapRegion& region : kept) {
    const RegionBounds bounds = bounds_of(region);
    const CellIndex low = first_cell_from(map, bounds.low_m);
    const CellIndex end = first_cell_from(map, bounds.high_m);
    box.min = {std::max(box.min.x, low.x), std::max(box.min.y, low.y)};
    box.end = {std::min(box.end.x, end.x), std::min(box.end.y, end.y)};
  }
  return box;
}

// On the lattice of the map, whose cells lie at whole multiples of their size.
double origin_of_part(double origin_m, double resolution_m, std::int32_t cells) {
  return (std::floor(origin_m / resolution_m + 0.5) + static_cast<double>(cells)) * resolution_m;
}

}  // namespace

bool MapRegion::contains(const Point2& point_m) const {
  bool is_inside = false;
  for (std::size_t k = 0, last = corners_m.size() - 1; k < corners_m.size(); last = k++) {
    const Point2& a = corners_m[k];
    const Point2& b = corners_m[last];
    if ((a.y() > point_m.y()) == (b.y() > point_m.y())) continue;
    const double x = a.x() + (b.x() - a.x()) * ((point_m.y() - a.y()) / (b.y() - a.y()));
    if (point_m.x() < x) is_inside = !is_inside;
  }
  return is_inside;
}

MapRegion rectangle_between(const Point2& low_m, const Point2& high_m) {
  return {{low_m, {high_m.x(), low_m.y()}, high_m, {low_m.x(), high_m.y()}}};
}

MapRegion in_frame(const Pose2& T_a_b, const MapRegion& region_b) {
  MapRegion region_a;
  region_a.corners_m.reserve(region_b.corners_m.size());
  for (const Point2& corner : region_b.corners_m) region_a.corners_m.push_back(T_a_b * corner);
  return region_a;
}

RegionBounds bounds_of(const MapRegion& region) {
  RegionBounds bounds{region.corners_m.front(), region.corners_m.front()};
  for (const Point2& corner : region.corners_m) {
    bounds.low_m = bounds.low_m.cwiseMin(corner);
    bounds.high_m = bounds.high_m.cwiseMax(corner);
  }
  return bounds;
}

std::uint64_t take_out_readings(const EndRules& rules, const ScanConfig& valid, const Pose2& T_map_base,
                                LaserScan& scan) {
  if (rules.erased.empty() && rules.kept.empty()) return 0;
  const double limit_m = range_limit_m(scan, valid.max_range_m);
  const bool moved = is_skewed(scan);
  std::uint64_t count = 0;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const auto range_m = static_cast<double>(scan.ranges_m[beam]);
    if (!(range_m >= valid.min_range_m && range_m < limit_m)) continue;  // false for NaN too
    const auto direction = beam_direction(scan, beam);
    const Pose2 T_base_laser = moved ? laser_at_beam(scan, beam) : scan.T_base_laser;
    const Point2 end_m = T_map_base * (T_base_laser * Point2(range_m * direction.cos, range_m * direction.sin));
    if (!is_taken_out(rules, end_m)) continue;
    scan.ranges_m[beam] = std::numeric_limits<float>::infinity();
    ++count;
  }
  return count;
}

OccupancyMap cropped(OccupancyMap map, const std::vector<MapRegion>& kept) {
  if (kept.empty()) return map;
  const CellBox box = cells_within(map.geometry, kept);
  if (box.empty()) {
    const GridGeometry& g = map.geometry;
    throw InputError(fmt::format("--crop leaves nothing of the map, which reaches from {:.2f},{:.2f} to {:.2f},{:.2f}",
                                 g.origin_x_m, g.origin_y_m, g.origin_x_m + g.width * g.resolution_m,
                                 g.origin_y_m + g.height * g.resolution_m));
  }
  OccupancyMap part;
  part.geometry = map.geometry;
  part.geometry.width = box.width();
  part.geometry.height = box.height();
  part.geometry.origin_x_m = origin_of_part(map.geometry.origin_x_m, map.geometry.resolution_m, box.min.x);
  part.geometry.origin_y_m = origin_of_part(map.geometry.origin_y_m, map.geometry.resolution_m, box.min.y);
  part.cells = CellStates(part.geometry.cell_count());
  std::size_t cell = 0;
  for (std::int32_t y = box.min.y; y < box.end.y; ++y) {
    for (std::int32_t x = box.min.x; x < box.end.x; ++x, ++cell) {
      const CellState state = map.at({x, y});
      if (state == CellState::kUnknown) continue;
      const Point2 centre_m = map.geometry.cell_centre({x, y});
      const auto has_it = [&centre_m](const MapRegion& region) { return region.contains(centre_m); };
      if (std::all_of(kept.begin(), kept.end(), has_it)) part.cells.set(cell, state);
    }
  }
  return part;
}

}  // namespace gdtslam

#include "map_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam::picture {
namespace {

constexpr double kStrayShare = 0.004;

/// First and end index if at most `spare` counts may be cut off at either end.
std::pair<std::int32_t, std::int32_t> trimmed(const std::vector<std::uint64_t>& counts, std::uint64_t spare) {
  std::size_t begin = 0;
  std::size_t end = counts.size();
  for (std::uint64_t cut = 0; begin < end && cut + counts[begin] <= spare; ++begin) cut += counts[begin];
  for (std::uint64_t cut = 0; end > begin && cut + counts[end - 1] <= spare; --end) cut += counts[end - 1];
  return {static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end)};
}

}  // namespace

Proportions picture_proportions(const PictureSize& size) {
  const double width = static_cast<double>(size.width);
  const double height = static_cast<double>(size.height);
  const double by_area = std::sqrt(width * height / (1600.0 * 1200.0));
  const double by_side = std::min(width, height) / 800.0;  // a narrow sheet has less room than its area suggests
  const double unit = std::max(0.5, std::min(by_area, by_side));
  Proportions sizes;
  sizes.unit = unit;
  sizes.title_px *= unit;
  sizes.body_px *= unit;
  sizes.small_px *= unit;
  sizes.line_px *= unit;
  sizes.margin_px *= unit;
  sizes.gap_px *= unit;
  return sizes;
}

bool is_on_sheet(const Point2& at) { return std::fabs(at.x()) <= kFarthest_px && std::fabs(at.y()) <= kFarthest_px; }

MapFrame fitted(const MapArea& area, const Panel& panel) {
  MapFrame frame;
  frame.panel = panel;
  frame.px_per_m = std::min(panel.width_px / area.width_m(), panel.height_px / area.height_m());
  frame.x_m = 0.5 * (area.min_x_m + area.max_x_m) - 0.5 * panel.width_px / frame.px_per_m;
  frame.y_m = 0.5 * (area.min_y_m + area.max_y_m) + 0.5 * panel.height_px / frame.px_per_m;
  return frame;
}

CellBox bounding_cells(const GridGeometry& geometry, const RowTest& test) {
  std::vector<std::uint64_t> columns(static_cast<std::size_t>(geometry.width));
  std::vector<std::uint64_t> rows(static_cast<std::size_t>(geometry.height));
  std::uint64_t total = 0;
  std::vector<std::uint8_t> passes(columns.size());
  for (std::int32_t y = 0; y < geometry.height; ++y) {
    test(y, passes);
    std::uint64_t& in_row = rows[static_cast<std::size_t>(y)];
    for (std::size_t x = 0; x < passes.size(); ++x) {
      columns[x] += passes[x];
      in_row += passes[x];
    }
    total += in_row;
  }
  const auto spare = static_cast<std::uint64_t>(kStrayShare * static_cast<double>(total));
  const auto [left, right] = trimmed(columns, spare);
  const auto [bottom, top] = trimmed(rows, spare);
  return {{left, bottom}, {right, top}};
}

MapArea map_area(const GridGeometry& geometry, const CellBox& box) {
  const double cell_m = geometry.resolution_m;
  return {geometry.origin_x_m + cell_m * box.min.x, geometry.origin_y_m + cell_m * box.min.y,
          geometry.origin_x_m + cell_m * box.end.x, geometry.origin_y_m + cell_m * box.end.y};
}

MapArea with_path(const MapArea& area, const GridGeometry& geometry, const Trajectory& trajectory, double margin_m) {
  const MapArea grid = map_area(geometry, {{0, 0}, {geometry.width, geometry.height}});
  const double reach_m = std::max(grid.width_m(), grid.height_m());
  MapArea all = area;
  for (const StampedPose& pose : trajectory) {
    const double x_m = pose.T_map_base.x_m;
    const double y_m = pose.T_map_base.y_m;
    const bool is_near = x_m >= grid.min_x_m - reach_m && x_m <= grid.max_x_m + reach_m &&
                         y_m >= grid.min_y_m - reach_m && y_m <= grid.max_y_m + reach_m;
    if (!is_near || !pose.T_map_base.is_finite()) continue;
    all.min_x_m = std::min(all.min_x_m, x_m);
    all.min_y_m = std::min(all.min_y_m, y_m);
    all.max_x_m = std::max(all.max_x_m, x_m);
    all.max_y_m = std::max(all.max_y_m, y_m);
  }
  return {all.min_x_m - margin_m, all.min_y_m - margin_m, all.max_x_m + margin_m, all.max_y_m + margin_m};
}

// Free cells are ignored: beams through windows reach far and would shrink the building.
MapArea shown_area(const OccupancyMap& map, const Trajectory& trajectory) {
  const auto width = static_cast<std::size_t>(map.geometry.width);
  std::vector<CellState> states(width);
  const auto box_of = [&](auto counts) {
    return bounding_cells(map.geometry, [&](std::int32_t y, std::span<std::uint8_t> passes) {
      map.cells.read(static_cast<std::size_t>(y) * width, states);
      std::transform(states.begin(), states.end(), passes.begin(),
                     [&](CellState state) { return static_cast<std::uint8_t>(counts(state)); });
    });
  };
  CellBox box = box_of([](CellState state) { return state == CellState::kOccupied; });
  const CellBox known = box_of([](CellState state) { return state != CellState::kUnknown; });
  // A post in an open hall is not the subject of the picture.
  constexpr std::int32_t kPost = 4;
  if (kPost * box.width() < known.width() && kPost * box.height() < known.height()) box = known;
  if (box.empty()) box = {{0, 0}, {map.geometry.width, map.geometry.height}};
  const MapArea area = map_area(map.geometry, box);
  constexpr double kMarginShare = 0.02;
  return with_path(area, map.geometry, trajectory,
                   std::max(2.0 * map.geometry.resolution_m, kMarginShare * std::max(area.width_m(), area.height_m())));
}

}  // namespace gdtslam::picture

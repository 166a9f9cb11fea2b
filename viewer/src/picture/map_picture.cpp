#include "gdtslam/viewer/map_picture.hpp"

#include <algorithm>

#include "picture/cell_image.hpp"
#include "picture/legend_items.hpp"
#include "picture/map_sheet.hpp"
#include "picture/path_layer.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr MapColours kColours{ink::kText, ink::kCard, colour_of(0xe4e2db)};

/// Walls and path count; free cells do not: beams through windows reach far and would shrink the building.
MapArea shown_area(const OccupancyMap& map, const Trajectory& trajectory) {
  CellBox box = box_of(map.geometry, [&](CellIndex cell) { return map.at(cell) == CellState::kOccupied; });
  if (box.empty()) box = box_of(map.geometry, [&](CellIndex cell) { return map.at(cell) != CellState::kUnknown; });
  if (box.empty()) box = {{0, 0}, {map.geometry.width, map.geometry.height}};
  const MapArea area = area_of(map.geometry, box);
  constexpr double kMarginShare = 0.02;
  return with_path(area, trajectory,
                   std::max(2.0 * map.geometry.resolution_m, kMarginShare * std::max(area.width_m(), area.height_m())));
}

}  // namespace

Canvas map_picture(const OccupancyMap& map, const PathOverlay& overlay, const MapLook& look, const PictureSize& size) {
  check(overlay);
  const PathColours& colours = path_colours(false);
  const Proportions sizes = proportions_of(size);
  const Sheet sheet = sheet_of(shown_area(map, overlay.trajectory), look, size, [&](double px_per_m) {
    std::vector<LegendItem> items{scale_bar_item(px_per_m, sizes), axes_item(sizes)};
    items.push_back(swatch_item("wall", kColours.wall, sizes));
    items.push_back(swatch_item("free", kColours.free, sizes));
    if (!look.is_transparent) items.push_back(swatch_item("unknown", kColours.unknown, sizes));
    add_path_items(items, overlay, look, colours, sizes);
    return items;
  });
  Canvas canvas(size.width, size.height, look.title.empty() ? "Map" : look.title);
  if (!look.is_transparent) canvas.rectangle({0.0, 0.0}, size.width, size.height, Fill{kColours.unknown});
  MapColours cells = kColours;
  cells.is_unknown_clear = true;
  const Panel& panel = sheet.frame.panel;
  canvas.begin_clip({panel.left_px, panel.top_px}, panel.width_px, panel.height_px);
  draw(canvas, occupancy_image(map, sheet.frame, cells));
  canvas.end_clip();
  draw_path(canvas, sheet.frame, overlay, look, colours, sizes);
  draw_title(canvas, sheet, look);
  draw_legend(canvas, sheet);
  return canvas;
}

}  // namespace gdtslam

#include "changes_picture.hpp"

#include <algorithm>
#include <string>

#include "cell_image.hpp"
#include "map_sheet.hpp"
#include "path_layer.hpp"

namespace gdtslam {
namespace {

using namespace picture;

/// Pale, so that changes stand out.
constexpr MapColours kChangesMap{colour_for(0x8f959d), ink::kCard, colour_for(0xebe9e3)};
constexpr Colour kAppeared = ink::kCoupler;
constexpr Colour kGone = ink::kCrank;
constexpr Colour kDrive = colour_for(0x9db7a8);

// Cells beside each other are one rectangle, and none is too small to be seen.
void draw_cells(Canvas& canvas, const MapFrame& frame, const GridGeometry& grid, const ChangesLayer& layer,
                Colour colour, const Proportions& sizes) {
  const double grown = std::max(0.0, 0.5 * (1.6 * sizes.line_px - grid.resolution_m * frame.px_per_m));
  for (std::size_t k = 0; k < layer.cells.size();) {
    const CellIndex first = layer.cells[k].cell;
    std::int32_t length = 0;
    while (k < layer.cells.size() && layer.cells[k].cell == first + CellOffset{length, 0}) ++k, ++length;
    const MapArea area = area_of(grid, {first, first + CellOffset{length, 1}});
    const Point2 corner = frame.pixel_of({area.min_x_m, area.max_y_m}) - Point2(grown, grown);
    canvas.rectangle(corner, area.width_m() * frame.px_per_m + 2.0 * grown,
                     area.height_m() * frame.px_per_m + 2.0 * grown, Fill{colour});
  }
}

std::vector<CellBox> boxes_of(const ChangesLayer& layer) {
  std::vector<CellBox> boxes(layer.patches);
  for (const auto& [cell, patch] : layer.cells) {
    CellBox& box = boxes.at(patch);
    if (box.empty()) box = {cell, cell + CellOffset{1, 1}};
    box.min = {std::min(box.min.x, cell.x), std::min(box.min.y, cell.y)};
    box.end = {std::max(box.end.x, cell.x + 1), std::max(box.end.y, cell.y + 1)};
  }
  return boxes;
}

void draw_frames(Canvas& canvas, const MapFrame& frame, const GridGeometry& grid, const ChangesLayer& layer,
                 Colour colour, const Proportions& sizes) {
  const double pad = 4.0 * sizes.line_px;
  for (const CellBox& box : boxes_of(layer)) {
    const MapArea area = area_of(grid, box);
    const Point2 corner = frame.pixel_of({area.min_x_m, area.max_y_m}) - Point2(pad, pad);
    canvas.rectangle(corner, area.width_m() * frame.px_per_m + 2.0 * pad, area.height_m() * frame.px_per_m + 2.0 * pad,
                     Fill{colour, 0.1}, Pen{.colour = colour, .width = 0.6 * sizes.line_px, .opacity = 0.55}, pad);
  }
}

std::string counted(const char* what, std::uint32_t places) {
  if (places == 0) return std::string("nothing ") + what;
  return std::string(what) + ": " + std::to_string(places) + (places == 1 ? " place" : " places");
}

MapLayer changes_layer(const GridGeometry& grid, const ChangesLayer& layer, const char* what, Colour colour) {
  return {[&grid, &layer, colour](Canvas& canvas, const MapFrame& frame, const Proportions& sizes) {
            draw_frames(canvas, frame, grid, layer, colour, sizes);
            draw_cells(canvas, frame, grid, layer, colour, sizes);
          },
          [&layer, what, colour](const LegendLook& look, double /*px_per_m*/) {
            return LegendItems{swatch_item(counted(what, layer.patches), colour, look)};
          }};
}

}  // namespace

Canvas changes_picture(const OccupancyMap& map, const ChangesOverlay& overlay, const MapLook& look,
                       const PictureSize& size) {
  const std::vector<std::size_t> one_drive;
  const double width = 0.6 * proportions_of(size).line_px;
  Theme theme = kLightTheme;
  theme.page = kChangesMap.unknown;
  Trajectory extent;
  for (const Trajectory& drive : overlay.drives) extent.insert(extent.end(), drive.begin(), drive.end());
  MapSheet sheet{"Changes", shown_area(map, extent), theme, {wall_layer(map, kChangesMap)}};
  for (const Trajectory& drive : overlay.drives) {
    sheet.layers.push_back(line_layer(drive, one_drive, "seen from here", kDrive, {std::nullopt, width}));
    if (sheet.layers.size() > 2) sheet.layers.back().explain = {};
  }
  sheet.layers.push_back(changes_layer(map.geometry, overlay.gone, "gone", kGone));
  sheet.layers.push_back(changes_layer(map.geometry, overlay.appeared, "new", kAppeared));
  return drawn(sheet, look, size);
}

}  // namespace gdtslam

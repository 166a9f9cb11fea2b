#include "changes_picture.hpp"

#include <algorithm>
#include <string>

#include "cell_image.hpp"
#include "map_sheet.hpp"

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

void draw_drives(Canvas& canvas, const MapFrame& frame, const ChangesOverlay& overlay, const Proportions& sizes) {
  for (const Trajectory& drive : overlay.drives) {
    std::vector<Point2> line;
    line.reserve(drive.size());
    for (const StampedPose& pose : drive) line.push_back(frame.pixel_of(pose.T_map_base.translation()));
    if (line.size() > 1) canvas.polyline(std::move(line), {.colour = kDrive, .width = 0.6 * sizes.line_px});
  }
}

LegendItem drive_item(const LegendLook& look) {
  const double length = 1.6 * look.sizes.body_px;
  const double indent = length + 0.5 * look.sizes.body_px;
  const std::string words = "seen from here";
  return {indent + text_width(words, look.sizes.body_px), look.sizes.body_px, [=](Canvas& canvas, const Point2& left) {
            canvas.line(left, left + Point2(length, 0.0), {.colour = kDrive, .width = 1.2 * look.sizes.line_px});
            canvas.text(left + Point2(indent, 0.36 * look.sizes.body_px), words,
                        {.size = look.sizes.body_px, .colour = look.theme.text});
          }};
}

std::string counted(const char* what, std::uint32_t places) {
  if (places == 0) return std::string("nothing ") + what;
  return std::string(what) + ": " + std::to_string(places) + (places == 1 ? " place" : " places");
}

}  // namespace

Canvas changes_picture(const OccupancyMap& map, const ChangesOverlay& overlay, const MapLook& look,
                       const PictureSize& size) {
  Theme theme = kLightTheme;
  theme.page = kChangesMap.unknown;
  const LegendLook legend{theme, proportions_of(size)};
  Trajectory extent;
  for (const Trajectory& drive : overlay.drives) extent.insert(extent.end(), drive.begin(), drive.end());
  const Sheet sheet = sheet_of(shown_area(map, extent), look, size, theme, [&](double px_per_m) {
    std::vector<LegendItem> items{scale_bar_item(px_per_m, legend), axes_item(legend)};
    items.push_back(swatch_item(counted("new", overlay.appeared.patches), kAppeared, legend));
    items.push_back(swatch_item(counted("gone", overlay.gone.patches), kGone, legend));
    items.push_back(swatch_item("wall", kChangesMap.wall, legend));
    if (!overlay.drives.empty()) items.push_back(drive_item(legend));
    return items;
  });
  Canvas canvas(size.width, size.height, look.title.empty() ? "Changes" : look.title);
  if (!look.is_transparent) canvas.rectangle({0.0, 0.0}, size.width, size.height, Fill{kChangesMap.unknown});
  MapColours cells = kChangesMap;
  cells.is_unknown_clear = true;
  const MapFrame frame = whole_sheet(sheet);
  draw(canvas, frame.panel, occupancy_image(map, frame, cells));
  draw_drives(canvas, frame, overlay, sheet.sizes);
  draw_frames(canvas, frame, map.geometry, overlay.gone, kGone, sheet.sizes);
  draw_frames(canvas, frame, map.geometry, overlay.appeared, kAppeared, sheet.sizes);
  draw_cells(canvas, frame, map.geometry, overlay.gone, kGone, sheet.sizes);
  draw_cells(canvas, frame, map.geometry, overlay.appeared, kAppeared, sheet.sizes);
  draw_words(canvas, sheet, look);
  return canvas;
}

}  // namespace gdtslam

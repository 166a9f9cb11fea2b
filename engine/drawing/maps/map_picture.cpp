#include "gdtslam/drawing/map_picture.hpp"

#include <algorithm>
#include <cstdint>

#include "cell_image.hpp"
#include "map_sheet.hpp"
#include "path_layer.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr MapColours kMapColours{ink::kText, ink::kCard, colour_for(0xe4e2db)};

}  // namespace

PictureSize size_for_content(double width, double height) {
  constexpr std::uint32_t kWidth_px = 1600;
  constexpr double kCaption_px = 240.0;  // title above, bars below
  constexpr double kLowest_px = 500.0;
  constexpr double kHighest_px = 1600.0;
  const double rows = height / std::max(width, 1e-3) * 0.92 * kWidth_px + kCaption_px;
  return {kWidth_px, static_cast<std::uint32_t>(std::clamp(rows, kLowest_px, kHighest_px))};
}

Canvas map_picture(const OccupancyMap& map, const PathOverlay& overlay, const MapLook& look, const PictureSize& size) {
  check(overlay);
  const PathColours colours =
      look.colour_map.empty() ? path_colours(false) : path_colours(colour_map(look.colour_map), false);
  Theme theme = kLightTheme;
  theme.page = kMapColours.unknown;
  const LegendLook legend{theme, proportions_of(size)};
  const Sheet sheet = sheet_of(shown_area(map, overlay.trajectory), look, size, theme, [&](double px_per_m) {
    std::vector<LegendItem> items{scale_bar_item(px_per_m, legend), axes_item(legend)};
    items.push_back(swatch_item("wall", kMapColours.wall, legend));
    items.push_back(swatch_item("free", kMapColours.free, legend));
    if (!look.is_transparent) items.push_back(swatch_item("unknown", kMapColours.unknown, legend));
    add_path_items(items, overlay, look, colours, legend);
    return items;
  });
  Canvas canvas(size.width, size.height, look.title.empty() ? "Map" : look.title);
  if (!look.is_transparent) canvas.rectangle({0.0, 0.0}, size.width, size.height, Fill{kMapColours.unknown});
  MapColours cells = kMapColours;
  cells.is_unknown_clear = true;
  const MapFrame frame = whole_sheet(sheet);
  draw(canvas, frame.panel, occupancy_image(map, frame, cells));
  draw_path(canvas, frame, overlay, look, colours, sheet.sizes);
  draw_words(canvas, sheet, look);
  return canvas;
}

}  // namespace gdtslam

#include "graph_picture.hpp"

#include "cell_image.hpp"
#include "graph_layer.hpp"
#include "map_sheet.hpp"

namespace gdtslam {
namespace {

using namespace picture;

/// Pale, so that lines over walls are seen.
constexpr MapColours kGraphMap{colour_for(0x868c95), ink::kCard, colour_for(0xebe9e3)};

}  // namespace

Canvas graph_picture(const OccupancyMap& map, const GraphOverlay& overlay, const MapLook& look,
                     const PictureSize& size) {
  check(overlay);
  Theme theme = kLightTheme;
  theme.page = kGraphMap.unknown;
  const Proportions sizes = proportions_of(size);
  const LegendLook legend{theme, sizes, size.width - 2.0 * sizes.margin_px};
  const Sheet sheet = sheet_of(shown_area(map, overlay.trajectory), look, size, theme, [&](double px_per_m) {
    std::vector<LegendItem> items{scale_bar_item(px_per_m, legend), axes_item(legend)};
    items.push_back(swatch_item("wall", kGraphMap.wall, legend));
    add_graph_items(items, overlay, px_per_m, legend);
    return items;
  });
  Canvas canvas(size.width, size.height, look.title.empty() ? "Graph" : look.title);
  if (!look.is_transparent) canvas.rectangle({0.0, 0.0}, size.width, size.height, Fill{kGraphMap.unknown});
  MapColours cells = kGraphMap;
  cells.is_unknown_clear = true;
  const MapFrame frame = whole_sheet(sheet);
  draw(canvas, frame.panel, occupancy_image(map, frame, cells));
  draw_graph(canvas, frame, overlay, sheet.sizes);
  draw_words(canvas, sheet, look);
  return canvas;
}

}  // namespace gdtslam

#include <algorithm>
#include <utility>
#include <vector>

#include "cell_image.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/ticks.hpp"
#include "map_sheet.hpp"
#include "path_layer.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr std::uint16_t kCell = 256;  // the field's unit is 1/256 cell
constexpr Colour kPaper = colour_for(0xf0eee8);

/// Obstacles and path with what the field says around them.
MapArea shown_area(const FieldPicture& field, const Trajectory& trajectory) {
  const GridGeometry& geometry = field.geometry;
  const auto value_at = [&](CellIndex cell) {
    return field.cells[static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(geometry.width) +
                       static_cast<std::size_t>(cell.x)];
  };
  CellBox box = box_of(geometry, [&](CellIndex cell) { return value_at(cell) < std::min(kCell, field.cap); });
  if (box.empty()) box = box_of(geometry, [&](CellIndex cell) { return value_at(cell) < field.cap; });
  if (box.empty()) box = {{0, 0}, {geometry.width, geometry.height}};
  const double reach_m = geometry.resolution_m * field.cap / kCell;
  return with_path(area_of(geometry, box), geometry, trajectory, std::max(reach_m, 2.0 * geometry.resolution_m));
}

/// How the field's values become colours.
struct FieldLook {
  const ColourMap& map;
  bool is_intensity = true;
  double least_share = 0.0;  ///< of the map's colours: the darkest are left to what is unknown
  Colour unknown;
  /// 0 at an obstacle, 1 at the cap.
  [[nodiscard]] Colour at(double distance_share) const {
    const double share = is_intensity ? 1.0 - distance_share : distance_share;
    return map.at(least_share + (1.0 - least_share) * share);
  }
};

FieldLook field_look(const MapLook& look) {
  constexpr double kDarkestShare = 0.22;
  if (look.is_intensity) {
    return {colour_map(look.colour_map.empty() ? "glow" : look.colour_map), true, kDarkestShare, ink::kNight};
  }
  return {colour_map(look.colour_map.empty() ? "lagoon" : look.colour_map), false, 0.0, kPaper};
}

/// Each value's colour once: a field has millions of cells.
FieldColours colours_of(const FieldLook& look, std::uint16_t cap, bool is_transparent) {
  std::vector<CellColour> table;
  for (std::uint32_t value = 0; value < cap; ++value) table.push_back({look.at(static_cast<double>(value) / cap), 255});
  const CellColour unknown{look.unknown, static_cast<std::uint8_t>(is_transparent ? 0 : 255)};
  return [table = std::move(table), unknown](std::uint16_t value) {
    return value < table.size() ? table[value] : unknown;
  };
}

std::vector<LegendItem> legend_of(const FieldPicture& field, const FieldLook& colours, const LegendLook& look) {
  const double reach_m = field.geometry.resolution_m * field.cap / kCell;
  std::vector<LegendItem> items;
  if (colours.is_intensity) {
    const auto bright = [=](double share) { return colours.at(1.0 - share); };
    items.push_back(colour_bar_item("intensity 0 at " + length_text(reach_m), "1 at obstacles", bright, look));
  } else {
    const auto far = [=](double share) { return colours.at(share); };
    items.push_back(colour_bar_item("nearest obstacle at 0 m", length_text(reach_m), far, look));
  }
  items.push_back(swatch_item("farther or unknown", colours.unknown, look));
  return items;
}

}  // namespace

Canvas field_picture(const FieldPicture& field, const PathOverlay& overlay, const MapLook& look,
                     const PictureSize& size) {
  check(field);
  check(overlay);
  const FieldLook field_colours = field_look(look);
  const PathColours& path = path_colours(look.is_intensity);
  // A transparent picture lies on pages that are light more often than not.
  Theme theme = look.is_intensity && !look.is_transparent ? kDarkTheme : kLightTheme;
  theme.page = field_colours.unknown;
  const LegendLook legend{theme, proportions_of(size)};
  const Sheet sheet = sheet_of(shown_area(field, overlay.trajectory), look, size, theme, [&](double px_per_m) {
    std::vector<LegendItem> items{scale_bar_item(px_per_m, legend), axes_item(legend)};
    for (LegendItem& item : legend_of(field, field_colours, legend)) items.push_back(std::move(item));
    add_path_items(items, overlay, look, path, legend);
    return items;
  });
  Canvas canvas(size.width, size.height, look.title.empty() ? "Distance field" : look.title);
  if (!look.is_transparent) canvas.rectangle({0.0, 0.0}, size.width, size.height, Fill{theme.page});
  const MapFrame frame = whole_sheet(sheet);
  draw(canvas, frame.panel, field_image(field, frame, colours_of(field_colours, field.cap, look.is_transparent)));
  draw_path(canvas, frame, overlay, look, path, sheet.sizes);
  draw_words(canvas, sheet, look);
  return canvas;
}

}  // namespace gdtslam

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

MapLayer field_layer(const FieldPicture& field, const FieldLook& colours, bool is_transparent) {
  return {[&field, &colours, is_transparent](Canvas& canvas, const MapFrame& frame, const Proportions& /*sizes*/) {
            draw(canvas, field_image(field, frame, colours_of(colours, field.cap, is_transparent)));
          },
          [&field, &colours](const LegendLook& look, double /*px_per_m*/) {
            const std::string reach = length_text(field.geometry.resolution_m * field.cap / kCell);
            const bool is_bright = colours.is_intensity;
            const auto colour_at = [&colours, is_bright](double share) {
              return colours.at(is_bright ? 1.0 - share : share);
            };
            return LegendItems{colour_bar_item(is_bright ? "intensity 0 at " + reach : "nearest obstacle at 0 m",
                                               is_bright ? "1 at obstacles" : reach, colour_at, look),
                               swatch_item("farther or unknown", colours.unknown, look)};
          }};
}

}  // namespace

Canvas field_picture(const FieldPicture& field, const PathOverlay& overlay, const MapLook& look,
                     const PictureSize& size) {
  check(field);
  check(overlay);
  const FieldLook colours = field_look(look);
  const PathColours path = path_colours(look.is_intensity);
  // A transparent picture lies on pages that are light more often than not.
  Theme theme = look.is_intensity && !look.is_transparent ? kDarkTheme : kLightTheme;
  theme.page = colours.unknown;
  return drawn({"Distance field",
                shown_area(field, overlay.trajectory),
                theme,
                {field_layer(field, colours, look.is_transparent), path_layer(overlay, look, path)}},
               look, size);
}

}  // namespace gdtslam

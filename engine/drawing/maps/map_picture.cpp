#include "gdtslam/drawing/map_picture.hpp"

#include <algorithm>
#include <cstdint>

#include "cell_image.hpp"
#include "graph_layer.hpp"
#include "map_sheet.hpp"
#include "path_layer.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr Colour kUnknownPage = colour_for(0xe4e2db);
constexpr MapColours kMapColours{ink::kText, ink::kCard, kUnknownPage};
/// Pale, so that lines over walls are seen.
constexpr MapColours kGraphMap{colour_for(0x868c95), ink::kCard, colour_for(0xebe9e3)};

Theme light_theme(Colour page) {
  Theme theme = kLightTheme;
  theme.page = page;
  return theme;
}

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
  const PathColours colours = path_colours(false, look.colour_map);
  MapSheet sheet{"Map", shown_area(map, overlay.trajectory), light_theme(kUnknownPage), {}};
  sheet.layers = {wall_layer(map, kMapColours), swatch_layer("free", kMapColours.free)};
  if (!look.is_transparent) sheet.layers.push_back(swatch_layer("unknown", kUnknownPage));
  sheet.layers.push_back(path_layer(overlay, look, colours));
  return drawn(sheet, look, size);
}

Canvas graph_picture(const OccupancyMap& map, const GraphOverlay& overlay, const MapLook& look,
                     const PictureSize& size) {
  check(overlay);
  return drawn({"Graph",
                shown_area(map, overlay.trajectory),
                light_theme(kGraphMap.unknown),
                {wall_layer(map, kGraphMap), graph_layer(overlay)}},
               look, size);
}

}  // namespace gdtslam

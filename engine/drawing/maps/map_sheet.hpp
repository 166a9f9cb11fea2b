// One sheet for all pictures of a map: layers upon a page, title above, legend below or beside, whichever leaves the
// map larger. Pixels. Thread-safe; O(items + layers).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "map_frame.hpp"

namespace gdtslam::picture {

/// One thing in the legend: how much room it takes, and how it is drawn from the middle of its left side.
struct LegendItem {
  double width_px = 0.0;
  double height_px = 0.0;
  std::function<void(Canvas&, const Point2&)> draw;
  bool begins_row = false;  ///< if one row does not hold all items: what belongs together stays together
};
using LegendItems = std::vector<LegendItem>;

/// How a legend is lettered.
struct LegendLook {
  Theme theme;
  Proportions sizes;
};

/// One layer of a sheet: its drawing and its entries in the legend. Either may be empty.
struct MapLayer {
  std::function<void(Canvas&, const MapFrame&, const Proportions&)> draw;
  std::function<LegendItems(const LegendLook&, double px_per_m)> explain;
};

/// A picture of a map as data. Layers are drawn in their order; what they refer to must live until then.
struct MapSheet {
  const char* name = "";  ///< title of a drawing whose look has none
  MapArea area;
  Theme theme;  ///< its page is the background
  std::vector<MapLayer> layers;
};
Canvas drawn(const MapSheet& sheet, const MapLook& look, const PictureSize& size);

/// A sheet below this side, pixels, has room for the map only: no words.
inline constexpr std::uint32_t kLeastSideWithWords = 200;

using LegendOf = std::function<LegendItems(double px_per_m)>;
struct Sheet {
  PictureSize size;
  Proportions sizes;
  Theme theme;
  MapFrame frame;
  LegendItems items;
  std::vector<Point2> places;  ///< of the items
};
Sheet sheet_of(const MapArea& area, const MapLook& look, const PictureSize& size, const Theme& theme,
               const LegendOf& legend);

/// Words no wider than `room_px`.
struct FittedWords {
  std::string text;
  double size_px = 0.0;
};
FittedWords fitted_words(const std::string& words, double size_px, double least_px, double room_px, bool is_bold);

/// "45 s", "12 min 5 s", "3 h 12 min".
std::string duration_text(double seconds);

/// A mark between words; either may be empty. The mark is drawn from the middle of its left side.
LegendItem legend_item(const std::string& before, double mark_px, std::function<void(Canvas&, const Point2&)> draw_mark,
                       const std::string& after, const LegendLook& look);
LegendItem scale_bar_item(double px_per_m, const LegendLook& look);
/// x to the right, y up: north of the map's frame.
LegendItem axes_item(const LegendLook& look);
LegendItem swatch_item(const std::string& words, Colour colour, const LegendLook& look);
LegendItem line_item(const std::string& words, const Pen& pen, const LegendLook& look);
/// A bar of colours between two words; `colour_at` takes a share.
LegendItem colour_bar_item(const std::string& before, const std::string& after, std::function<Colour(double)> colour_at,
                           const LegendLook& look);

/// A layer without a drawing.
MapLayer swatch_layer(const std::string& words, Colour colour);
/// Lines across the whole sheet, as far apart as the scale bar is long.
MapLayer grid_layer(Colour colour);

}  // namespace gdtslam::picture

// The sheet around a map: title above, legend below or beside it, whichever leaves the map larger. Pixels.
// Thread-safe; O(items).
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "map_frame.hpp"
#include "path_layer.hpp"

namespace gdtslam::picture {

/// One thing in the legend: how much room it takes, and how it is drawn from the middle of its left side.
struct LegendItem {
  double width_px = 0.0;
  double height_px = 0.0;
  std::function<void(Canvas&, const Point2&)> draw;
  bool begins_row = false;  ///< where one row does not hold all items: what belongs together stays together
};
using LegendOf = std::function<std::vector<LegendItem>(double px_per_m)>;

/// A sheet below this side, pixels, has room for the map only: no words.
inline constexpr std::uint32_t kLeastSideWithWords = 200;

struct Sheet {
  PictureSize size;
  Proportions sizes;
  Theme theme;
  MapFrame frame;
  std::vector<LegendItem> items;
  std::vector<Point2> places;  ///< of the items
};
Sheet sheet_of(const MapArea& area, const MapLook& look, const PictureSize& size, const Theme& theme,
               const LegendOf& legend);

/// The same map on the whole sheet: what was seen beyond the walls ends where it ends, not at the border of a panel.
MapFrame whole_sheet(const Sheet& sheet);

/// Title and subtitle, made smaller or cut with an ellipsis where they are too long, and the legend; what of the map
/// lies under them is dimmed.
void draw_words(Canvas& canvas, const Sheet& sheet, const MapLook& look);

/// Words no wider than `room_px`.
struct FittedWords {
  std::string text;
  double size_px = 0.0;
};
FittedWords fitted_words(const std::string& words, double size_px, double least_px, double room_px, bool is_bold);

// What legends consist of: scale bar, axes, the colours of time, marks with their number, colours of cells.

/// "45 s", "12 min 5 s", "3 h 12 min".
std::string duration_text(double seconds);

/// How a legend is lettered.
struct LegendLook {
  Theme theme;
  Proportions sizes;
  double room_px = std::numeric_limits<double>::infinity();  ///< an item that is wider says less
};
LegendItem scale_bar_item(double px_per_m, const LegendLook& look);
/// x to the right, y up: north of the map's frame.
LegendItem axes_item(const LegendLook& look);
LegendItem swatch_item(const std::string& words, Colour colour, const LegendLook& look);
/// A bar of colours between two words; `colour_at` takes a share.
LegendItem colour_bar_item(const std::string& before, const std::string& after, std::function<Colour(double)> colour_at,
                           const LegendLook& look);
/// Those that the overlay asks for: time, keyframes, doubtful scans.
void add_path_items(std::vector<LegendItem>& items, const PathOverlay& overlay, const MapLook& look,
                    const PathColours& colours, const LegendLook& legend);

}  // namespace gdtslam::picture

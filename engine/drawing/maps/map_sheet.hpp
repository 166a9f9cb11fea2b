// The common sheet of all pictures of a map: the map's position, layers on a page, the title above, and the legend
// below or beside, whichever leaves the map larger. Map: metres, y up; picture: pixels, y down. Thread-safe; O(items +
// layers), and O(cells) for the boxes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/grids.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/image.hpp"
#include "gdtslam/drawing/map_picture.hpp"

namespace gdtslam::picture {

/// Sizes of words, lines and gaps, which scale with the picture.
struct Proportions {
  double unit = 1.0;  ///< 1 at 1600 x 1200; at least 0.5, so that words stay legible
  double title_px = 28.0;
  double body_px = 18.0;
  double small_px = 15.0;
  double line_px = 2.4;
  double margin_px = 36.0;
  double gap_px = 44.0;  ///< between the items of a legend
};
Proportions picture_proportions(const PictureSize& size);

/// A part of the plane, metres.
struct MapArea {
  double min_x_m = 0.0;
  double min_y_m = 0.0;
  double max_x_m = 0.0;
  double max_y_m = 0.0;
  [[nodiscard]] double width_m() const { return max_x_m - min_x_m; }
  [[nodiscard]] double height_m() const { return max_y_m - min_y_m; }
};

/// A rectangle of the picture, whole pixels.
struct Panel {
  double left_px = 0.0;
  double top_px = 0.0;
  double width_px = 0.0;
  double height_px = 0.0;
};

/// The panel and the part of the map in it.
struct MapFrame {
  Panel panel;
  double x_m = 0.0;  ///< map coordinates at the panel's upper left corner
  double y_m = 0.0;
  double px_per_m = 1.0;
  [[nodiscard]] Point2 to_pixel(const Point2& point_m) const {
    return {panel.left_px + (point_m.x() - x_m) * px_per_m, panel.top_px + (y_m - point_m.y()) * px_per_m};
  }
};
/// False for points that are not finite or beyond Cairo's coordinates.
bool is_on_sheet(const Point2& at);
/// Fits the area into the middle of the panel; the panel shows its surroundings too.
MapFrame fitted(const MapArea& area, const Panel& panel);

/// Writes 1 for each cell of a row that is part of the picture's subject, else 0.
using RowTest = std::function<void(std::int32_t y, std::span<std::uint8_t> passes)>;
/// The box of the cells that pass, without 0.4 % at each side, which are ends of beams through windows; empty if none
/// passes.
CellBox bounding_cells(const GridGeometry& geometry, const RowTest& test);
MapArea map_area(const GridGeometry& geometry, const CellBox& box);
/// The area with the whole path and a margin; without poses farther outside the grid than its length, which would
/// shrink the map to nothing.
MapArea with_path(const MapArea& area, const GridGeometry& geometry, const Trajectory& trajectory, double margin_m);

/// The subject of an occupancy map's picture: its walls and the path, with a margin.
MapArea shown_area(const OccupancyMap& map, const Trajectory& trajectory);

/// An entry of the legend: its width, and its drawing from the middle of its left side.
struct LegendItem {
  double width_px = 0.0;
  double height_px = 0.0;
  std::function<void(Canvas&, const Point2&)> draw;
  bool begins_row = false;  ///< start of a new row if one row cannot hold all items
};
using LegendItems = std::vector<LegendItem>;

/// Lettering of a legend.
struct LegendLook {
  Theme theme;
  Proportions sizes;
};

/// One layer of a sheet: its drawing and its entries in the legend. Either may be empty.
struct MapLayer {
  std::function<void(Canvas&, const MapFrame&, const Proportions&)> draw;
  std::function<LegendItems(const LegendLook&, double px_per_m)> explain;
};

/// A picture of a map as data. Layers are drawn in order; their references must live until then.
struct MapSheet {
  const char* name = "";  ///< default title of the drawing
  MapArea area;
  Theme theme;  ///< its page is the background
  std::vector<MapLayer> layers;
};
/// The light theme on a page of this colour.
Theme light_theme(Colour page);
Canvas drawn(const MapSheet& sheet, const MapLook& look, const PictureSize& size);

/// Sheets with a side below this, pixels, show only the map, without words.
inline constexpr std::uint32_t kLeastSideWithWords = 200;

using LegendOf = std::function<LegendItems(double px_per_m)>;
struct Sheet {
  PictureSize size;
  Proportions sizes;
  Theme theme;
  MapFrame frame;
  LegendItems items;
  std::vector<Point2> places;  ///< one for each item
};
Sheet lay_out_sheet(const MapArea& area, const MapLook& look, const PictureSize& size, const Theme& theme,
                    const LegendOf& legend);

/// Words shortened to `room_px`.
struct FittedWords {
  std::string text;
  double size_px = 0.0;
};
FittedWords fitted_words(const std::string& words, double size_px, double least_px, double room_px, bool is_bold);

/// "45 s", "12 min 5 s", "3 h 12 min".
std::string duration_text(double seconds);

/// A mark between two words, which may be empty. The mark is drawn from the middle of its left side.
LegendItem legend_item(const std::string& before, double mark_px, std::function<void(Canvas&, const Point2&)> draw_mark,
                       const std::string& after, const LegendLook& look);
LegendItem scale_bar_item(double px_per_m, const LegendLook& look);
/// Axes of the map's frame: x to the right, y up.
LegendItem axes_item(const LegendLook& look);
LegendItem swatch_item(const std::string& words, Colour colour, const LegendLook& look);
LegendItem line_item(const std::string& words, const Pen& pen, const LegendLook& look);
/// A colour bar between two words; `colour_at` receives a share.
LegendItem colour_bar_item(const std::string& before, const std::string& after, std::function<Colour(double)> colour_at,
                           const LegendLook& look);

/// A legend entry without a drawing.
MapLayer swatch_layer(const std::string& words, Colour colour);
/// A grid over the whole sheet, with the length of the scale bar as spacing.
MapLayer grid_layer(Colour colour);

}  // namespace gdtslam::picture

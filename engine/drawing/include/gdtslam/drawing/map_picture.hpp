// Pictures and plots of a 2D run: map and distance field with the path, the small distance transform with its numbers,
// errors over time, as box plot and as distribution. Frame: map, metres, y up. Thread-safe; O(cells + pixels + poses):
// 0.05 s for 2.4 million cells at 1600 x 1200, to which the raster adds 0.1 s.
//
// Words and lines grow with the picture. The legend stands below the map or beside it, whichever leaves the map larger;
// a picture with a side below 200 pixels has no words. If there are more cells than pixels, thin walls are still drawn.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/grids.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam {

/// A distance field in 1/256 cell, row-major, the lower left cell first; at `cap` a cell is that far or unknown.
struct FieldPicture {
  GridGeometry geometry;
  std::vector<std::uint16_t> cells;
  std::uint16_t cap = 0;
};

/// Path and marks that lie over a map.
struct PathOverlay {
  Trajectory trajectory;
  std::vector<std::size_t> keyframes;  ///< indices into the trajectory
  std::vector<std::size_t> doubtful;   ///< indices, too
  std::vector<std::size_t> drives{};   ///< indices at which another drive begins: no line leads there
};

/// Content and colours of a picture of a map or a field.
struct MapLook {
  std::string title;
  std::string subtitle;
  std::string colour_map;  ///< colours of the field; empty: "glow" for intensity, else "lagoon" (drawing/colour.hpp)
  bool with_path = true;
  bool with_keyframes = true;
  bool is_intensity = true;  ///< field bright near obstacles, as figures 4 and 7 print it; else distance in m
  bool is_transparent = false;
};

/// Size of a still without a stated size: 1600 pixels wide, as high as content of these proportions needs, from 500 to
/// 1600. `width` and `height` in any one unit: only their ratio counts.
PictureSize size_for_content(double width, double height);
/// The occupancy map: walls, what was seen free, and the path in the colours of time. Cropped to walls and path,
/// without poses farther outside the grid than it is long. The rest of the sheet shows what was seen beyond them.
/// Throws InputError if an index is beyond the trajectory.
Canvas map_picture(const OccupancyMap& map, const PathOverlay& overlay, const MapLook& look, const PictureSize& size);
/// The distance field, with a colour bar in metres or as intensity. Throws InputError as map_picture() does and for a
/// field without cells; ConfigError for a colour map that there is not.
Canvas field_picture(const FieldPicture& field, const PathOverlay& overlay, const MapLook& look,
                     const PictureSize& size);

/// Errors by group: one box (quartiles, whiskers at 1.5 times their distance, points beyond) for each. Quantiles lie
/// between the two nearest values (definition 7 of [Hyndman1996]); values that are not finite are counted, and the
/// picture states their number.
struct ErrorGroup {
  std::string name;
  std::vector<double> values;  ///< in `unit`
};
/// Errors of several groups under one title.
struct ErrorPlot {
  std::string title;
  std::string quantity;  ///< "Position error"
  std::string unit;      ///< "m"
  std::vector<ErrorGroup> groups;
};
Canvas box_plot(const ErrorPlot& plot, const PictureSize& size);
/// Share of values up to x, one curve a group, with the median and the 95 % marks. The axis ends at three times the
/// largest 95 % mark; the picture states the largest value.
Canvas distribution_plot(const ErrorPlot& plot, const PictureSize& size);
/// Values over time, one curve a group; (seconds, value). A value that is not finite leaves a gap. If many points share
/// a column of pixels, its least and largest value are drawn, so that no spike is lost and the drawing stays small.
struct TimeSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;
};
Canvas time_plot(const std::string& title, const std::string& quantity, const std::string& unit,
                 const std::vector<TimeSeries>& series, const PictureSize& size);

}  // namespace gdtslam

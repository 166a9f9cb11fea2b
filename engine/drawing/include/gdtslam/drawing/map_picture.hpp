// Pictures and plots of a 2D run: map and distance field with the path, the small distance transform with its numbers,
// errors over time, as box plot and as distribution. Frame: map, metres, y up. Thread-safe; O(cells + pixels + poses):
// 0.05 s for 2.4 million cells at 1600 x 1200, plus 0.1 s for the raster. Words and lines scale with the picture. The
// legend is below or beside the map, whichever leaves the map larger; a picture with a side below 200 pixels has no
// words. Thin walls are visible even if there are more cells than pixels.
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

/// A distance field in 1/256 cell, row-major, the lower left cell first; `cap` means at least that far, or unknown.
struct FieldPicture {
  GridGeometry geometry;
  std::vector<std::uint16_t> cells;
  std::uint16_t cap = 0;
};

/// Path and marks over a map.
struct PathOverlay {
  Trajectory trajectory;
  std::vector<std::size_t> keyframes;  ///< indices into the trajectory
  std::vector<std::size_t> doubtful;   ///< indices, too
  std::vector<std::size_t> drives{};   ///< first indices of further drives: no line leads there
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

/// Default size of a still: 1600 pixels wide, and 500 to 1600 high by the content's proportions. `width` and `height`
/// in any common unit: only their ratio matters.
PictureSize size_for_content(double width, double height);
/// The occupancy map: walls, free cells, and the path in the colours of time. Cropped to walls and path; poses farther
/// outside the grid than its length are ignored. The rest of the sheet shows observed cells beyond them. Throws
/// InputError if an index is beyond the trajectory.
Canvas map_picture(const OccupancyMap& map, const PathOverlay& overlay, const MapLook& look, const PictureSize& size);
/// The distance field, with a colour bar in metres or as intensity. Throws InputError like map_picture() and for a
/// field without cells; ConfigError for an unknown colour map.
Canvas field_picture(const FieldPicture& field, const PathOverlay& overlay, const MapLook& look,
                     const PictureSize& size);

/// Errors by group: one box each (quartiles, whiskers at 1.5 times their distance, points beyond). Quantiles are
/// interpolated between the two nearest values (definition 7 of [Hyndman1996]). Values that are not finite are only
/// counted, and the picture states their number.
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
/// Share of values up to x, one curve per group, with marks at the median and at 95 %. The axis ends at three times the
/// largest 95 % mark; the picture states the largest value.
Canvas distribution_plot(const ErrorPlot& plot, const PictureSize& size);
/// Values over time, one curve per group; (seconds, value). A value that is not finite leaves a gap. If many points
/// share a column of pixels, their extremes are drawn, so that no spike is lost and the drawing stays small.
struct TimeSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;
};
Canvas time_plot(const std::string& title, const std::string& quantity, const std::string& unit,
                 const std::vector<TimeSeries>& series, const PictureSize& size);

}  // namespace gdtslam

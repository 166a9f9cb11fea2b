// Pictures and plots of a 2D run: map and distance field with the path, the small distance transform with its numbers,
// errors over time, as box plot and as distribution. Frame: map, metres, y up. Thread-safe; O(cells + poses).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/viewer/camera.hpp"

namespace gdtslam {

/// A distance field in 1/256 cell, row-major, the lower left cell first; at `cap` a cell is that far or unknown.
struct FieldPicture {
  GridGeometry geometry;
  std::vector<std::uint16_t> cells;
  std::uint16_t cap = 0;
};

/// What lies over a map.
struct PathOverlay {
  Trajectory trajectory;
  std::vector<std::size_t> keyframes;  ///< indices into the trajectory
  std::vector<std::size_t> doubtful;   ///< likewise
};

struct MapLook {
  std::string title;
  std::string subtitle;
  std::string colour_map;  ///< of the field; empty: the default
  bool with_path = true;
  bool with_keyframes = true;
  bool is_intensity = true;  ///< of the field: bright near obstacles, as figures 4 and 7 print it; else distance in m
  bool is_transparent = false;
};

/// The occupancy map.
Canvas map_picture(const OccupancyMap& map, const PathOverlay& overlay, const MapLook& look, const PictureSize& size);
/// The distance field, with a colour bar in metres or as intensity.
Canvas field_picture(const FieldPicture& field, const PathOverlay& overlay, const MapLook& look,
                     const PictureSize& size);
/// Figure 3: the distances of a small part of a field as numbers in its cells, obstacles filled. At most 60 cells a
/// side. Distances in cells, squared where asked, with one decimal where they are not whole.
Canvas cells_picture(const FieldPicture& field, const CellBox& part, bool is_squared, const MapLook& look);

/// Errors by group: one box (quartiles, whiskers at 1.5 times their distance, points beyond) for each.
struct ErrorGroup {
  std::string name;
  std::vector<double> values;  ///< in `unit`
};
struct ErrorPlot {
  std::string title;
  std::string quantity;  ///< "Position error"
  std::string unit;      ///< "m"
  std::vector<ErrorGroup> groups;
};
Canvas box_plot(const ErrorPlot& plot, const PictureSize& size);
/// Share of values up to x, one curve a group, with the median and the 95 % marks.
Canvas distribution_plot(const ErrorPlot& plot, const PictureSize& size);
/// Values over time, one curve a group; (time, value).
struct TimeSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;
};
Canvas time_plot(const std::string& title, const std::string& quantity, const std::string& unit,
                 const std::vector<TimeSeries>& series, const PictureSize& size);

}  // namespace gdtslam

// Where a map lies in a picture, and how large words and lines are there. Map: metres, y up; picture: pixels, y down.
// Thread-safe; constant time but for the boxes, O(cells).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/grids.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam::picture {

/// Sizes of words, lines and gaps: they grow with the picture, so that it looks the same on a sheet of any size.
struct Proportions {
  double unit = 1.0;  ///< 1 at 1600 x 1200; not below a half, where words would no longer be legible
  double title_px = 28.0;
  double body_px = 18.0;
  double small_px = 15.0;
  double line_px = 2.4;
  double margin_px = 36.0;
  double gap_px = 44.0;  ///< between the items of a legend
};
Proportions proportions_of(const PictureSize& size);

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

/// The panel with its part of the map.
struct MapFrame {
  Panel panel;
  double x_m = 0.0;  ///< of the panel's upper left corner
  double y_m = 0.0;
  double px_per_m = 1.0;
  [[nodiscard]] Point2 pixel_of(const Point2& point_m) const {
    return {panel.left_px + (point_m.x() - x_m) * px_per_m, panel.top_px + (y_m - point_m.y()) * px_per_m};
  }
};
/// False for what is not finite, and beyond Cairo's coordinates.
bool is_on_sheet(const Point2& at);
/// The area in the middle of the panel, as large as fits; the panel shows what lies around it too.
MapFrame fitted(const MapArea& area, const Panel& panel);

/// Whether a cell is part of what the picture is about.
using CellTest = std::function<bool(CellIndex)>;
/// The box of the cells that pass, without the few (0.4 % at each side) in which beams through windows end; empty when
/// none passes.
CellBox box_of(const GridGeometry& geometry, const CellTest& test);
MapArea area_of(const GridGeometry& geometry, const CellBox& box);
/// The area with the whole path in it and a margin around; without poses that lie farther outside the grid than it is
/// long, beside which nothing of the map would be seen.
MapArea with_path(const MapArea& area, const GridGeometry& geometry, const Trajectory& trajectory, double margin_m);

/// The part of an occupancy map that a picture of it is about: its walls and the path, with a margin.
MapArea shown_area(const OccupancyMap& map, const Trajectory& trajectory);

}  // namespace gdtslam::picture

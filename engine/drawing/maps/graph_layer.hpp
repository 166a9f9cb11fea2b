// What of a graph lies over a map, and what its legend says of it. Pixels. Thread-safe; O(poses + loops).
#pragma once

#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "graph_picture.hpp"
#include "map_frame.hpp"
#include "map_sheet.hpp"

namespace gdtslam::picture {

/// Throws InputError where an index of the overlay is beyond the trajectory, or the covariances are not its own.
void check(const GraphOverlay& overlay);

/// How ellipses are drawn: every so many metres of path, so many times as large.
struct EllipseScale {
  double every_m = 0.0;  ///< nothing where there are none
  double factor = 1.0;   ///< 1, 2 or 5 times a power of ten
};
EllipseScale ellipse_scale(const GraphOverlay& overlay, double px_per_m, const Proportions& sizes);

void draw_graph(Canvas& canvas, const MapFrame& frame, const GraphOverlay& overlay, const Proportions& sizes);

/// Those of what there is: keyframes, loops, ellipses, doubtful stretches.
void add_graph_items(std::vector<LegendItem>& items, const GraphOverlay& overlay, double px_per_m,
                     const LegendLook& look);

}  // namespace gdtslam::picture

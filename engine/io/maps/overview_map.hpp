// The map's part of the overview: which piece of it is shown, and its pixels. Thread-safe.
#pragma once

#include "canvas.hpp"
#include "overview.hpp"

namespace gdtslam {

/// A rectangle of the map frame, metres.
struct MapArea {
  double min_x_m = 0.0;
  double min_y_m = 0.0;
  double max_x_m = 0.0;
  double max_y_m = 0.0;
};

/// What is occupied, without stray returns (what is known when nothing is occupied), and where the robot was, with a
/// margin; a metre square when there is nothing.
MapArea shown_area(const OverviewInput& input);

/// Fills the frame's rectangle: each pixel is the mean of the cells under it, where occupied cells weigh more in small
/// pictures so that thin walls stay visible.
void draw_map(RgbImage& image, const OverviewFrame& frame, const OccupancyMap& map);

}  // namespace gdtslam

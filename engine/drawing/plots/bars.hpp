// A picture's scale: a colour bar with ticks, a scale bar of round length, a grid. Sizes follow the text size. O(1)
// shapes.
#pragma once

#include <string>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam {

/// Length of a tick, of bars and of axes.
inline constexpr double kTick_px = 4.0;
/// Size of the ticks' letters, as a share of the text's.
inline constexpr double kTickLetters = 0.92;
/// From the base line to the middle of figures, as a share of their size.
inline constexpr double kHalfFigure = 0.36;

struct ColourBar {
  const ColourMap* map = nullptr;
  double from = 0.0;  ///< value at the map's first colour
  double to = 1.0;
  std::string title = {};  ///< with the unit: "height in m"
  TickSteps steps = TickSteps::kDecimal;
  double length = 240.0;    ///< pixels, along the colours
  double thickness = 14.0;  ///< across them
  double text_size = 13.0;
  bool has_halo = false;  ///< letters over a picture
};
/// Size of the bar with its words, for placing it. Only width and height are set.
DrawingArea colour_bar_room(const ColourBar& bar);
/// A horizontal bar with the upper left corner of its room at `corner`, the title above, the largest value at the
/// right. Both ends are labelled, and the round values in between that have room.
void draw_colour_bar(Canvas& canvas, const ColourBar& bar, const Point2& corner, const Theme& theme = kLightTheme);

struct ScaleBar {
  double pixels_per_m = 100.0;
  double most = 160.0;  ///< longest bar, pixels
  double text_size = 13.0;
  bool has_halo = true;
};
/// The left end is at `start`, the length above the middle. Draws nothing if no round length fits.
void draw_scale_bar(Canvas& canvas, const ScaleBar& bar, const Point2& start, const Theme& theme = kLightTheme);

/// Grid lines over an area, every `step_px`, through a point of the page. Draws nothing for steps below a pixel.
void draw_grid(Canvas& canvas, const DrawingArea& area, const Point2& through, double step_px);

}  // namespace gdtslam

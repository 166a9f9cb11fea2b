// One plot with axes in the house's drawing style. Pixels, x right, y down. One object belongs to one thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {

/// A round scale: from, to and the step of its lines.
struct PlotScale {
  double from = 0.0;
  double to = 1.0;
  double step = 1.0;
};
/// Covers both ends with about five steps of 1, 2 or 5 times a power of ten.
PlotScale round_scale(double from, double to);

struct PlotFrame {
  Point2 corner = Point2::Zero();  ///< upper left of the card
  double width = 0.0;
  double height = 0.0;
  PlotScale x;
  PlotScale y;
  std::string x_name;
  std::string y_name;
};

class ScatterPlot {
 public:
  /// Draws the card, its heading, lines and names.
  ScatterPlot(Canvas& canvas, PlotFrame frame, std::string_view heading, std::string_view remark);
  [[nodiscard]] Point2 at(double x, double y) const;
  [[nodiscard]] bool holds(double x, double y) const;
  void dot(double x, double y, Colour colour, double radius);
  /// What is outside is cut off at the frame's edge by leaving it out.
  void curve(const std::vector<Point2>& points, const Pen& pen);
  void level(double y, const Pen& pen);
  void band(double from_y, double to_y, Colour fill);
  /// A sample of the colour and what it means, in the upper right corner, one after the other from the right.
  void legend(Colour colour, bool is_line, std::string_view words);

 private:
  Canvas& canvas_;
  PlotFrame frame_;
  double legend_x_;
};

}  // namespace gdtslam

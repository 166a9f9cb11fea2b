// How parts leave pictures in their folder, and how they end when they are stopped. Thread-safe.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "part.hpp"
#include "tools/gdtslam/pictures/options.hpp"

namespace gdtslam::reproduce {

/// Throws Error(kInterrupted) where the work is to stop.
void go_on(const PartContext& place);

/// Writes the drawing under that name (.svg, or .png of `scale` pixels for each of the drawing) and adds it.
void add_picture(Part& part, const PartContext& place, const Canvas& drawing, Picture picture, double scale = 1.0);

/// A white sheet with its title and a line of words above what is to be drawn.
Canvas titled_sheet(double width, double height, const std::string& title, const std::string& words);

/// A view of `gdtslam render` of these inputs, drawn as that command draws it.
struct ViewOrder {
  std::vector<std::string> inputs;
  std::string view;
  std::string size;  ///< empty: the view's own
  RenderOptions options{};
};
void add_view(Part& part, const PartContext& place, const ViewOrder& order, Picture picture);

/// "1.23 cm", "0.004 m": a length in the unit that reads best.
std::string length_with_unit(double length_m);

}  // namespace gdtslam::reproduce

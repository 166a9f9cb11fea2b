// The page under a plot, and what plots of errors share. Thread-safe; O(values).
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/plot.hpp"

namespace gdtslam::picture {

/// Draws on a page of natural size and gives it back in the size that is asked for.
using DrawPlot = std::function<void(Canvas&, const DrawingArea&)>;
Canvas plot_sheet(const std::string& title, const PictureSize& size, const DrawPlot& draw);
/// How every plot is lettered, on that page.
PlotLook plot_look(const std::string& title);
/// From one value to another, outwards to whole ticks where it grows.
Axis axis_of(const std::string& title, double from, double to, bool is_grown);
/// "Position error (m)", as every axis and bar of ours has it; without a unit the quantity alone.
std::string axis_title(const std::string& quantity, const std::string& unit);
/// "0.0210 m": three figures that count.
std::string value_text(double value, const std::string& unit);

/// The finite values of a group, ascending, and how many had no value: those are told, never hidden.
struct SortedGroup {
  std::string name;
  std::vector<double> values;
  std::size_t without_value = 0;
};
std::vector<SortedGroup> sorted_groups(const ErrorPlot& plot);
/// "1,234 values", with what was left out: "1,230 values, 4 not finite".
std::string count_text(const SortedGroup& group);

}  // namespace gdtslam::picture

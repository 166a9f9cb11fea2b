// Ways through CIELAB along which equal steps look equally large. Thread-safe; O(colours).
#pragma once

#include <cstddef>
#include <vector>

#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {

/// A place in CIELAB's plane of hues.
struct Hue {
  double green_red = 0.0;
  double blue_yellow = 0.0;
};

/// From one lightness to another through at least two hues: lightness changes evenly and so does the place among the
/// hues, so that every step is equally far in CIELAB.
std::vector<Colour> even_path(double from_lightness, double to_lightness, const std::vector<Hue>& places,
                              std::size_t count);
/// A tilted circle around grey: yellow lightest, blue darkest, green and red half way. The last colour is one step
/// before the first.
std::vector<Colour> even_circle(double middle_lightness, double lightness_swing, double radius, std::size_t count);

}  // namespace gdtslam

// A font of strokes, drawn for this project: no font file, any size. ASCII; any other character is a box.
#pragma once

#include <string_view>

#include "canvas.hpp"

namespace gdtslam {

struct TextStyle {
  double cap_height_px = 16.0;
  PixelColour colour{};
};

/// Width of the text in pixels.
double text_width(std::string_view text, const TextStyle& style);
/// Draws with the left end of the baseline at `origin`. Returns the x where the text ends.
double draw_text(Layer& layer, Pixel2 origin, std::string_view text, const TextStyle& style);

}  // namespace gdtslam

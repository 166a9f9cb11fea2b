// Drawings as pixels and as PDF, by Cairo: no display, no OpenGL. Thread-safe; O(pixels + shapes).
// Both throw UnavailableError where there are words and no font, and Error where Cairo fails.
#pragma once

#include <string>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam {

/// `scale` pixels for each pixel of the drawing. Throws Error too for a side that has not 1 to 32767 pixels.
RgbaImage raster_of(const Canvas& drawing, double scale = 1.0);
/// One page, 96 pixels an inch, words stay words. The same bytes for the same drawing (no time of day).
std::string pdf_of(const Canvas& drawing);

}  // namespace gdtslam

// Drawings as pixels and as PDF, by Cairo: no display, no OpenGL. Thread-safe; O(pixels + shapes).
#pragma once

#include <string>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam {

/// `scale` pixels for each pixel of the drawing. Throws Error beyond 2^15 pixels a side.
RgbaImage raster_of(const Canvas& drawing, double scale = 1.0);
/// One page, 96 pixels an inch, words stay words. The same bytes for the same drawing (no time of day).
std::string pdf_of(const Canvas& drawing);

}  // namespace gdtslam

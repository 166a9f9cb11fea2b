// Drawings as pixels, SVG and PDF, by Cairo: no display, no OpenGL. Thread-safe; O(pixels + shapes).
// All throw UnavailableError if the drawing has words and there is no font, and Error if Cairo fails.
#pragma once

#include <string>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam {

/// `scale` pixels for each pixel of the drawing. Throws Error too for a side that has not 1 to 32767 pixels.
RgbaImage raster_of(const Canvas& drawing, double scale = 1.0);
/// Letters are outlines; the words stand in the description, for screen readers and searches. The same bytes for the
/// same drawing and fonts.
std::string svg_of(const Canvas& drawing);
/// One page, 96 pixels an inch, words stay words. The same bytes for the same drawing (no time of day).
std::string pdf_of(const Canvas& drawing);

}  // namespace gdtslam

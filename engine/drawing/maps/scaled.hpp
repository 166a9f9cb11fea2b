// A drawing made larger or smaller as a whole: plots are laid out at one size and look the same at any other. Dashes
// keep their length. Thread-safe; O(shapes).
#pragma once

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam::picture {

/// Exactly `size` large; `unit` times the drawing.
Canvas scaled(const Canvas& drawing, double unit, const PictureSize& size);

}  // namespace gdtslam::picture

// Pixels as JPEG, by libjpeg-turbo. Thread-safe; O(pixels).
#pragma once

#include <string>

#include "gdtslam/drawing/image.hpp"

namespace gdtslam {

/// The bytes of a file, the same for the same pixels; what is transparent is drawn as if it were not. Throws Error
/// where the library fails.
std::string jpeg_of(const RgbaImage& image);

}  // namespace gdtslam

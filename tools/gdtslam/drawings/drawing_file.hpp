// A drawing as the bytes of a file, by the file's extension. Thread-safe; O(shapes + pixels).
#pragma once

#include <string>
#include <string_view>

#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {

/// Pixels of a PNG for each of a page-sized drawing: its small letters are crisp on dense displays.
inline constexpr double kDensePng = 2.0;

/// Before the work begins: throws UsageError that names the option for another extension.
void check_drawing_file(std::string_view option, const std::string& file);

/// By the extension, in small or capital letters. A PNG has `scale` pixels for each of the drawing. Throws as above.
std::string drawing_bytes(const Canvas& drawing, const std::string& file, double scale = 1.0);

/// The bytes of a PNG file.
std::string png_bytes(const RgbaImage& image);

}  // namespace gdtslam

// A drawing as the bytes of a file, by the file's extension. Thread-safe; O(shapes + pixels).
#pragma once

#include <string>
#include <string_view>

#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {

/// PNG pixels per unit of a page-sized drawing: small letters stay crisp on dense displays.
inline constexpr double kDensePng = 2.0;

/// Call it before the work: throws UsageError that names the option if the extension is unknown.
void check_drawing_file(std::string_view option, const std::string& file);

/// Format by the extension, in upper or lower case. A PNG has `scale` pixels per unit of the drawing. Throws
/// UsageError.
std::string drawing_bytes(const Canvas& drawing, const std::string& file, double scale = 1.0);

/// The bytes of a PNG file.
std::string png_bytes(const RgbaImage& image);

}  // namespace gdtslam

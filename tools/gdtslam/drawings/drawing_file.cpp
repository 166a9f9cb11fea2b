#include "drawing_file.hpp"

#include <fmt/format.h>

#include "engine/io/maps/png.hpp"
#include "engine/io/referenced_file.hpp"
#include "gdtslam/core/error.hpp"
#ifdef GDTSLAM_HAS_VIEWER
#include "gdtslam/drawing/raster.hpp"
#endif

namespace gdtslam {
namespace {

#ifdef GDTSLAM_HAS_VIEWER
constexpr bool kHasViewer = true;
#else
constexpr bool kHasViewer = false;
// Never reached: check_drawing_file() refuses before.
RgbaImage raster_of(const Canvas& /*drawing*/, double /*scale*/) { return {}; }
std::string pdf_of(const Canvas& /*drawing*/) { return {}; }
#endif

}  // namespace

void check_drawing_file(std::string_view option, const std::string& file) {
  const std::string extension = extension_of(file);
  const std::string lead = option.empty() ? "" : std::string(option) + ": ";
  if (extension != ".svg" && extension != ".png" && extension != ".pdf") {
    throw UsageError(fmt::format("{}'{}' does not say what to write: let it end in .svg, .png or .pdf", lead, file));
  }
  if (extension != ".svg" && !kHasViewer) {
    throw UnavailableError(
        fmt::format("{}'{}': PNG and PDF are drawn by the viewer, which is not built in: write .svg", lead, file));
  }
}

std::string drawing_bytes(const Canvas& drawing, const std::string& file, double scale) {
  check_drawing_file("", file);
  const std::string extension = extension_of(file);
  if (extension == ".png") return png_bytes(raster_of(drawing, scale));
  if (extension == ".pdf") return pdf_of(drawing);
  return svg_of(drawing, png_bytes);
}

std::string png_bytes(const RgbaImage& image) { return encode_png(image.width, image.height, image.pixels); }

}  // namespace gdtslam

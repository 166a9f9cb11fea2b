#include "drawing_file.hpp"

#include <fmt/format.h>

#include "engine/io/maps/png.hpp"
#include "engine/io/referenced_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {

void check_drawing_file(std::string_view option, const std::string& file) {
  const std::string extension = extension_of(file);
  if (extension == ".svg" || extension == ".png" || extension == ".pdf") return;
  const std::string lead = option.empty() ? "" : std::string(option) + ": ";
  throw UsageError(fmt::format("{}'{}' does not say what to write: let it end in .svg, .png or .pdf", lead, file));
}

std::string drawing_bytes(const Canvas& drawing, const std::string& file, double scale) {
  check_drawing_file("", file);
  const std::string extension = extension_of(file);
  if (extension == ".svg") return draw_svg(drawing);
  if (extension == ".pdf") return draw_pdf(drawing);
  return png_bytes(rasterise(drawing, scale));
}

std::string png_bytes(const RgbaImage& image) { return encode_png(image.width, image.height, image.pixels); }

}  // namespace gdtslam

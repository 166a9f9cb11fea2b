#include "gdtslam/drawing/raster.hpp"

#include <cmath>
#include <cstring>

#include "cairo_painter.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kMostPixels = 32768.0;

std::uint32_t pixels_of(double length, double scale) {
  const double pixels = std::ceil(length * scale - 1e-6);
  if (!(pixels >= 1.0 && pixels < kMostPixels)) {
    throw Error(ExitCode::kFailed, "a picture has 1 to 32767 pixels a side, not " + std::to_string(length * scale));
  }
  return static_cast<std::uint32_t>(pixels);
}

/// A film's frame: the drawing begins with a picture of its own size, which need not be composed with anything.
bool begins_with_background(const Canvas& drawing, double scale, const RgbaImage& image) {
  if (scale != 1.0 || drawing.shapes().empty()) return false;
  const auto* const picture = std::get_if<shape::Picture>(&drawing.shapes().front());
  return picture != nullptr && picture->corner == Point2::Zero() && picture->image->width == image.width &&
         picture->image->height == image.height && picture->width == static_cast<double>(image.width) &&
         picture->height == static_cast<double>(image.height);
}

std::uint8_t colour_for(std::uint32_t premultiplied, std::uint32_t alpha) {
  return static_cast<std::uint8_t>((premultiplied * 255U + alpha / 2U) / alpha);
}

void copy_pixels(const std::uint8_t* rows, std::size_t row_bytes, RgbaImage& image) {
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const std::uint8_t* from = rows + row_bytes * y;
    std::uint8_t* to = image.at(0, y);
    for (std::uint32_t x = 0; x < image.width; ++x, from += 4, to += 4) {
      std::uint32_t word = 0;
      std::memcpy(&word, from, sizeof(word));
      const std::uint32_t alpha = word >> 24U;
      if (alpha == 0U) continue;
      if (alpha == 255U) {
        to[0] = static_cast<std::uint8_t>(word >> 16U);
        to[1] = static_cast<std::uint8_t>(word >> 8U);
        to[2] = static_cast<std::uint8_t>(word);
      } else {
        to[0] = colour_for(word >> 16U & 0xFFU, alpha);
        to[1] = colour_for(word >> 8U & 0xFFU, alpha);
        to[2] = colour_for(word & 0xFFU, alpha);
      }
      to[3] = static_cast<std::uint8_t>(alpha);
    }
  }
}

}  // namespace

RgbaImage raster_of(const Canvas& drawing, double scale) {
  RgbaImage image(pixels_of(drawing.width(), scale), pixels_of(drawing.height(), scale));
  const CairoSurface surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, static_cast<int>(image.width), static_cast<int>(image.height)));
  check_cairo(cairo_surface_status(surface.get()), "making a picture");
  const auto row_bytes = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  std::size_t next = 0;
  if (begins_with_background(drawing, scale, image)) {
    cairo_surface_flush(surface.get());
    copy_premultiplied(*std::get<shape::Picture>(drawing.shapes().front()).image,
                       cairo_image_surface_get_data(surface.get()), row_bytes);
    cairo_surface_mark_dirty(surface.get());
    next = 1;
  }
  const CairoContext context(cairo_create(surface.get()));
  cairo_scale(context.get(), scale, scale);
  CairoPainter painter(context.get());
  for (; next < drawing.shapes().size(); ++next) std::visit(painter, drawing.shapes()[next]);
  check_cairo(cairo_status(context.get()), "drawing a picture");
  cairo_surface_flush(surface.get());
  copy_pixels(cairo_image_surface_get_data(surface.get()), row_bytes, image);
  return image;
}

}  // namespace gdtslam

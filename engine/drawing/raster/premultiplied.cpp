// Between our pixels (bytes red, green, blue, alpha) and Cairo's (words of alpha, red, green, blue, the colours
// multiplied by alpha).
#include <cassert>
#include <cstring>

#include "cairo_painter.hpp"

namespace gdtslam {
namespace {

std::uint32_t times(std::uint32_t colour, std::uint32_t alpha) {
  const std::uint32_t product = colour * alpha + 128U;
  return (product + (product >> 8U)) >> 8U;  // colour * alpha / 255, rounded
}

std::uint32_t word_of(const std::uint8_t* pixel) {
  const std::uint32_t alpha = pixel[3];
  if (alpha == 255U) {
    return 0xFF000000U | static_cast<std::uint32_t>(pixel[0]) << 16U | static_cast<std::uint32_t>(pixel[1]) << 8U |
           pixel[2];
  }
  return alpha << 24U | times(pixel[0], alpha) << 16U | times(pixel[1], alpha) << 8U | times(pixel[2], alpha);
}

}  // namespace

void copy_premultiplied(const RgbaImage& image, std::uint8_t* rows, std::size_t row_bytes) {
  assert(image.pixels.size() == std::size_t{4} * image.width * image.height);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const std::uint8_t* from = image.at(0, y);
    std::uint8_t* to = rows + row_bytes * y;
    for (std::uint32_t x = 0; x < image.width; ++x, from += 4, to += 4) {
      const std::uint32_t word = word_of(from);
      std::memcpy(to, &word, sizeof(word));
    }
  }
}

CairoSurface surface_of(const RgbaImage& image) {
  CairoSurface surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, static_cast<int>(image.width), static_cast<int>(image.height)));
  check_cairo(cairo_surface_status(surface.get()), "taking an image into a drawing");
  cairo_surface_flush(surface.get());
  copy_premultiplied(image, cairo_image_surface_get_data(surface.get()),
                     static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get())));
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

}  // namespace gdtslam

#include "gdtslam/drawing/raster.hpp"

#include <cairo-pdf.h>

#include <cassert>
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

// Between our pixels (bytes red, green, blue, alpha) and Cairo's (words of alpha, red, green, blue, the colours
// multiplied by alpha).

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

std::uint8_t colour_for(std::uint32_t premultiplied, std::uint32_t alpha) {
  return static_cast<std::uint8_t>((premultiplied * 255U + alpha / 2U) / alpha);
}

// Where the words lie, so that a picture is in memory once.
void become_pixels(RgbaImage& image) {
  const std::uint8_t* const end = image.pixels.data() + image.pixels.size();
  for (std::uint8_t* at = image.pixels.data(); at < end; at += 4) {
    std::uint32_t word = 0;
    std::memcpy(&word, at, sizeof(word));
    const std::uint32_t alpha = word >> 24U;
    const bool is_through = alpha == 0U || alpha == 255U;  // without alpha there are no colours
    at[0] = is_through ? static_cast<std::uint8_t>(word >> 16U) : colour_for(word >> 16U & 0xFFU, alpha);
    at[1] = is_through ? static_cast<std::uint8_t>(word >> 8U) : colour_for(word >> 8U & 0xFFU, alpha);
    at[2] = is_through ? static_cast<std::uint8_t>(word) : colour_for(word & 0xFFU, alpha);
    at[3] = static_cast<std::uint8_t>(alpha);
  }
}

constexpr double kPointsPerPixel = 72.0 / 96.0;

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
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

RgbaImage raster_of(const Canvas& drawing, double scale) {
  RgbaImage image(pixels_of(drawing.width(), scale), pixels_of(drawing.height(), scale));
  const std::size_t row_bytes = std::size_t{4} * image.width;
  const CairoSurface surface(
      cairo_image_surface_create_for_data(image.pixels.data(), CAIRO_FORMAT_ARGB32, static_cast<int>(image.width),
                                          static_cast<int>(image.height), static_cast<int>(row_bytes)));
  check_cairo(cairo_surface_status(surface.get()), "making a picture");
  std::size_t next = 0;
  if (begins_with_background(drawing, scale, image)) {
    cairo_surface_flush(surface.get());
    copy_premultiplied(*std::get<shape::Picture>(drawing.shapes().front()).image, image.pixels.data(), row_bytes);
    cairo_surface_mark_dirty(surface.get());
    next = 1;
  }
  const CairoContext context(cairo_create(surface.get()));
  cairo_scale(context.get(), scale, scale);
  CairoPainter painter(context.get());
  for (; next < drawing.shapes().size(); ++next) std::visit(painter, drawing.shapes()[next]);
  check_cairo(cairo_status(context.get()), "drawing a picture");
  cairo_surface_finish(surface.get());
  become_pixels(image);
  return image;
}

std::string pdf_of(const Canvas& drawing) {
  std::string bytes;
  const CairoSurface surface(cairo_pdf_surface_create_for_stream(&append, &bytes, drawing.width() * kPointsPerPixel,
                                                                 drawing.height() * kPointsPerPixel));
  check_cairo(cairo_surface_status(surface.get()), "making a PDF");
  // The same drawing gives the same bytes: without the time of day that Cairo would write.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, drawing.title().c_str());
  {
    const CairoContext context(cairo_create(surface.get()));
    cairo_scale(context.get(), kPointsPerPixel, kPointsPerPixel);
    CairoPainter painter(context.get());
    for (const Shape& shape : drawing.shapes()) std::visit(painter, shape);
    cairo_show_page(context.get());
    check_cairo(cairo_status(context.get()), "drawing a PDF");
  }
  cairo_surface_finish(surface.get());
  check_cairo(cairo_surface_status(surface.get()), "writing a PDF");
  return bytes;
}

}  // namespace gdtslam

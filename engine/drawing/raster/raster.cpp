#include "gdtslam/drawing/canvas.hpp"

#include <cairo-pdf.h>
#include <cairo-svg.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <map>
#include <string_view>

#include "cairo_painter.hpp"
#include "engine/drawing/letters.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kMostPixels = 32768.0;

std::uint32_t count_pixels(double length, double scale) {
  const double pixels = std::ceil(length * scale - 1e-6);
  if (!(pixels >= 1.0 && pixels < kMostPixels)) {
    throw Error(ExitCode::kFailed, "a picture has 1 to 32767 pixels a side, not " + std::to_string(length * scale));
  }
  return static_cast<std::uint32_t>(pixels);
}

// Conversion between our pixels (bytes red, green, blue, alpha) and Cairo's (words of alpha, red, green, blue,
// premultiplied).

std::uint32_t times(std::uint32_t colour, std::uint32_t alpha) {
  const std::uint32_t product = colour * alpha + 128U;
  return (product + (product >> 8U)) >> 8U;  // colour * alpha / 255, rounded
}

std::uint32_t to_word(const std::uint8_t* pixel) {
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

// Converts in place, to keep a picture in memory only once.
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

void paint(const Canvas& drawing, const CairoSurface& surface, double scale) {
  const CairoContext context(cairo_create(surface.get()));
  cairo_scale(context.get(), scale, scale);
  CairoPainter painter(context.get());
  for (const Shape& shape : drawing.shapes()) std::visit(painter, shape);
  check_cairo(cairo_status(context.get()), "drawing a picture");
}

void finish_page(const CairoSurface& surface) {
  cairo_surface_show_page(surface.get());
  cairo_surface_finish(surface.get());
  check_cairo(cairo_surface_status(surface.get()), "writing a picture");
}

/// Cairo numbers images per process. Numbering them by their order makes the text depend on the drawing alone.
std::string numbered_by_order(const std::string& svg) {
  std::string text;
  std::map<std::string, std::size_t> numbers;
  std::size_t copied = 0;
  for (std::size_t at = svg.find_first_of("\"#"); at != std::string::npos; at = svg.find_first_of("\"#", at + 1)) {
    for (const std::string_view name : {"image", "surface"}) {
      const std::size_t begin = at + 1 + name.size();
      if (svg.compare(at + 1, name.size(), name) != 0) continue;
      const std::size_t end = svg.find_first_not_of("0123456789", begin);
      if (end == begin || end == std::string::npos) continue;
      const auto [number, is_new] = numbers.try_emplace(svg.substr(begin, end - begin), numbers.size() + 1);
      text += svg.substr(copied, begin - copied) + std::to_string(number->second);
      copied = end;
    }
  }
  return text + svg.substr(copied);
}

/// Adds title and words for screen readers and searches, because letters are outlines.
std::string described(const Canvas& drawing) {
  std::string words;
  for (const Shape& shape : drawing.shapes()) {
    if (const auto* const line = std::get_if<shape::Words>(&shape)) words += markup_text(line->text) + "\n";
  }
  return "<title>" + markup_text(drawing.title()) + "</title>\n<desc>" + words + "</desc>\n";
}

bool has_square_pixels(const Canvas& drawing) {
  return std::any_of(drawing.shapes().begin(), drawing.shapes().end(), [](const Shape& shape) {
    const auto* const picture = std::get_if<shape::Picture>(&shape);
    return picture != nullptr && !picture->is_smooth;
  });
}

}  // namespace

CairoSurface make_surface(const RgbaImage& image) {
  assert(image.pixels.size() == std::size_t{4} * image.width * image.height);
  CairoSurface surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, static_cast<int>(image.width), static_cast<int>(image.height)));
  check_cairo(cairo_surface_status(surface.get()), "taking an image into a drawing");
  cairo_surface_flush(surface.get());
  std::uint8_t* const rows = cairo_image_surface_get_data(surface.get());
  const auto row_bytes = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const std::uint8_t* from = image.at(0, y);
    std::uint8_t* to = rows + row_bytes * y;
    for (std::uint32_t x = 0; x < image.width; ++x, from += 4, to += 4) {
      const std::uint32_t word = to_word(from);
      std::memcpy(to, &word, sizeof(word));
    }
  }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

RgbaImage rasterise(const Canvas& drawing, double scale) {
  RgbaImage image(count_pixels(drawing.width(), scale), count_pixels(drawing.height(), scale));
  const std::size_t row_bytes = std::size_t{4} * image.width;
  const CairoSurface surface(
      cairo_image_surface_create_for_data(image.pixels.data(), CAIRO_FORMAT_ARGB32, static_cast<int>(image.width),
                                          static_cast<int>(image.height), static_cast<int>(row_bytes)));
  check_cairo(cairo_surface_status(surface.get()), "making a picture");
  paint(drawing, surface, scale);
  cairo_surface_finish(surface.get());
  become_pixels(image);
  return image;
}

std::string draw_svg(const Canvas& drawing) {
  std::string bytes;
  const CairoSurface surface(cairo_svg_surface_create_for_stream(&append, &bytes, drawing.width(), drawing.height()));
  check_cairo(cairo_surface_status(surface.get()), "making an SVG");
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_USER);
  paint(drawing, surface, 1.0);
  finish_page(surface);
  std::string svg = numbered_by_order(bytes.substr(bytes.find("<svg ")));
  const std::string style = has_square_pixels(drawing) ? " style=\"image-rendering:pixelated\"" : "";
  svg.insert(svg.find(">\n") + 2, described(drawing));
  return svg.insert(svg.find(' '), " role=\"img\"" + style);  // inherited by every image
}

std::string draw_pdf(const Canvas& drawing) {
  std::string bytes;
  const CairoSurface surface(cairo_pdf_surface_create_for_stream(&append, &bytes, drawing.width() * kPointsPerPixel,
                                                                 drawing.height() * kPointsPerPixel));
  check_cairo(cairo_surface_status(surface.get()), "making a PDF");
  // Without Cairo's time of day the same drawing gives the same bytes.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, drawing.title().c_str());
  paint(drawing, surface, kPointsPerPixel);
  finish_page(surface);
  return bytes;
}

}  // namespace gdtslam

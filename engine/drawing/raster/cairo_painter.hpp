// A drawing's shapes, drawn by Cairo on whatever surface is given; as SVG has them, so that all forms look alike.
// One object belongs to one thread; different threads may paint at once. O(shapes + pixels).
#pragma once

#include <cairo.h>

#include <cstdint>
#include <memory>
#include <string>

#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {

struct CairoDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
  void operator()(cairo_font_options_t* options) const { cairo_font_options_destroy(options); }
};
using CairoSurface = std::unique_ptr<cairo_surface_t, CairoDeleter>;
using CairoContext = std::unique_ptr<cairo_t, CairoDeleter>;

/// Throws Error unless all went well; `what` was done, in a few words.
void check_cairo(cairo_status_t status, const std::string& what);

/// Of an image, its colours multiplied by their alpha as Cairo wants them.
CairoSurface surface_of(const RgbaImage& image);
/// The same, into rows of a surface that has the image's size.
void copy_premultiplied(const RgbaImage& image, std::uint8_t* rows, std::size_t row_bytes);

/// std::visit with it draws a shape.
class CairoPainter {
 public:
  explicit CairoPainter(cairo_t* context);

  void operator()(const shape::Rectangle& box);
  void operator()(const shape::Line& line);
  void operator()(const shape::Polygon& polygon);
  void operator()(const shape::Circle& circle);
  void operator()(const shape::Words& words);
  void operator()(const shape::Picture& picture);
  void operator()(const shape::ClipBegin& clip);
  void operator()(const shape::ClipEnd& clip);

 private:
  void fill(const std::optional<Fill>& fill);
  void stroke(const std::optional<Pen>& pen);
  void use_font(const Lettering& lettering);

  cairo_t* context_;
  int open_clips_ = 0;
  bool has_font_ = false;
};

}  // namespace gdtslam

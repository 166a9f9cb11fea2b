// Draws shapes with Cairo, for pixels, SVG and PDF alike. One object belongs to one thread; different threads may paint
// at once. O(shapes + pixels).
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
  void operator()(cairo_font_face_t* face) const { cairo_font_face_destroy(face); }
  void operator()(cairo_scaled_font_t* font) const { cairo_scaled_font_destroy(font); }
};
using CairoSurface = std::unique_ptr<cairo_surface_t, CairoDeleter>;
using CairoContext = std::unique_ptr<cairo_t, CairoDeleter>;
using CairoFont = std::unique_ptr<cairo_scaled_font_t, CairoDeleter>;

/// Throws Error if Cairo failed; `what` names the action.
void check_cairo(cairo_status_t status, const std::string& what);

/// Copies an image with premultiplied colours, the format of Cairo.
CairoSurface make_surface(const RgbaImage& image);
/// The font of all drawings. Throws UnavailableError if there is no font.
CairoFont scaled_font(bool is_bold, double size);

/// Visitor for std::visit that draws a shape.
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

  cairo_t* context_;
  int open_clips_ = 0;
};

}  // namespace gdtslam

// Painting of shapes with Cairo, and widths of words.
#include "cairo_painter.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/drawing/letters.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"

#ifdef GDTSLAM_SANITIZE_ADDRESS
// Fontconfig stores pointers as offsets, which the leak checker cannot follow.
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig\n"; }
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }
#endif

namespace gdtslam {
namespace {

/// Debian's "sans"; fontconfig substitutes the nearest one if it is not installed.
constexpr const char* kFace = "DejaVu Sans";
constexpr double kHalo_px = 4.0;
constexpr std::size_t kMostDashes = 8;

void set_colour(cairo_t* context, Colour colour, double opacity) {
  cairo_set_source_rgba(context, colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0, opacity);
}

/// Converts "4 3" to Cairo's form.
void set_dashes(cairo_t* context, std::string_view text) {
  std::array<double, kMostDashes> lengths{};
  int count = 0;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at < end && count < static_cast<int>(kMostDashes)) {
    if (*at == ' ' || *at == ',') {
      ++at;
      continue;
    }
    const auto [next, fault] = std::from_chars(at, end, lengths.at(static_cast<std::size_t>(count)));
    if (fault != std::errc{}) break;
    at = next;
    ++count;
  }
  cairo_set_dash(context, lengths.data(), count, 0.0);
}

void trace(cairo_t* context, const std::vector<Point2>& points) {
  cairo_new_path(context);
  for (const Point2& point : points) cairo_line_to(context, point.x(), point.y());
}

void trace(cairo_t* context, const shape::Rectangle& box) {
  cairo_new_path(context);
  const double radius = std::min({box.radius, 0.5 * box.width, 0.5 * box.height});
  const Point2 near = box.corner;
  const Point2 far = near + Point2(box.width, box.height);
  if (radius <= 0.0) {
    cairo_rectangle(context, near.x(), near.y(), box.width, box.height);
    return;
  }
  cairo_arc(context, far.x() - radius, near.y() + radius, radius, -0.5 * kPi, 0.0);
  cairo_arc(context, far.x() - radius, far.y() - radius, radius, 0.0, 0.5 * kPi);
  cairo_arc(context, near.x() + radius, far.y() - radius, radius, 0.5 * kPi, kPi);
  cairo_arc(context, near.x() + radius, near.y() + radius, radius, kPi, 1.5 * kPi);
  cairo_close_path(context);
}

/// Set explicitly, so that a desktop's font settings do not change pictures.
std::unique_ptr<cairo_font_options_t, CairoDeleter> font_options() {
  std::unique_ptr<cairo_font_options_t, CairoDeleter> options(cairo_font_options_create());
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_SLIGHT);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  return options;
}

using CairoFace = std::unique_ptr<cairo_font_face_t, CairoDeleter>;
CairoFace font_face(bool is_bold) {
  return CairoFace(cairo_toy_font_face_create(kFace, CAIRO_FONT_SLANT_NORMAL,
                                              is_bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL));
}

double text_start(Anchor anchor, double advance) {
  switch (anchor) {
    case Anchor::kMiddle:
      return -0.5 * advance;
    case Anchor::kEnd:
      return -advance;
    case Anchor::kStart:
      break;
  }
  return 0.0;
}

constexpr double kMeasured_px = 1000.0;  ///< font size for measuring; widths are proportional

/// All threads may use this font.
cairo_scaled_font_t* measured_font(bool is_bold) {
  static const CairoFont fonts[] = {scaled_font(false, kMeasured_px), scaled_font(true, kMeasured_px)};
  return fonts[is_bold ? 1 : 0].get();
}

}  // namespace

void check_cairo(cairo_status_t status, const std::string& what) {
  if (status == CAIRO_STATUS_SUCCESS) return;
  throw Error(ExitCode::kFailed, what + " failed: " + cairo_status_to_string(status));
}

CairoPainter::CairoPainter(cairo_t* context) : context_(context) {
  cairo_set_line_cap(context_, CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(context_, CAIRO_LINE_JOIN_ROUND);
  cairo_set_font_options(context_, font_options().get());
}

// Without a font Cairo uses its own letters, only A to z: words would be wrong without notice.
CairoFont scaled_font(bool is_bold, double size) {
  cairo_matrix_t scale;
  cairo_matrix_init_scale(&scale, size, size);
  cairo_matrix_t identity;
  cairo_matrix_init_identity(&identity);
  CairoFont font(cairo_scaled_font_create(font_face(is_bold).get(), &scale, &identity, font_options().get()));
  if (cairo_scaled_font_status(font.get()) != CAIRO_STATUS_SUCCESS ||
      cairo_scaled_font_get_type(font.get()) == CAIRO_FONT_TYPE_USER) {
    throw UnavailableError("a picture has words, and no font is installed; install one (Debian: fonts-dejavu-core)");
  }
  return font;
}

void CairoPainter::fill(const std::optional<Fill>& fill) {
  if (!fill) return;
  set_colour(context_, fill->colour, fill->opacity);
  cairo_fill_preserve(context_);
}

void CairoPainter::stroke(const std::optional<Pen>& pen) {
  if (!pen || !(pen->width > 0.0)) return;
  set_colour(context_, pen->colour, pen->opacity);
  cairo_set_line_width(context_, pen->width);
  set_dashes(context_, pen->dashes);
  cairo_stroke(context_);
}

void CairoPainter::operator()(const shape::Rectangle& box) {
  trace(context_, box);
  fill(box.fill);
  stroke(box.edge);
}

void CairoPainter::operator()(const shape::Line& line) {
  trace(context_, line.points);
  stroke(line.pen);
}

void CairoPainter::operator()(const shape::Polygon& polygon) {
  trace(context_, polygon.points);
  cairo_close_path(context_);
  fill(polygon.fill);
}

void CairoPainter::operator()(const shape::Circle& circle) {
  cairo_new_path(context_);
  cairo_arc(context_, circle.centre.x(), circle.centre.y(), std::max(0.0, circle.radius), 0.0, 2.0 * kPi);
  cairo_close_path(context_);
  fill(circle.fill);
  stroke(circle.edge);
}

void CairoPainter::operator()(const shape::Words& words) {
  const Lettering& lettering = words.lettering;
  cairo_set_font_face(context_, font_face(lettering.is_bold).get());
  cairo_set_font_size(context_, lettering.size);
  const char* const text = words.text.c_str();
  cairo_save(context_);
  cairo_translate(context_, words.at.x(), words.at.y());
  if (words.is_upright) cairo_rotate(context_, -0.5 * kPi);
  const double start = text_start(lettering.anchor, text_width(words.text, lettering.size, lettering.is_bold));
  if (lettering.has_halo) {
    cairo_new_path(context_);
    cairo_move_to(context_, start, 0.0);
    cairo_text_path(context_, text);
    stroke(Pen{.colour = lettering.halo, .width = kHalo_px});
  }
  cairo_move_to(context_, start, 0.0);
  set_colour(context_, lettering.colour, 1.0);
  cairo_show_text(context_, text);
  cairo_restore(context_);
}

void CairoPainter::operator()(const shape::Picture& picture) {
  const RgbaImage& image = *picture.image;
  if (image.width == 0 || image.height == 0) return;
  const CairoSurface surface = make_surface(image);
  cairo_save(context_);
  cairo_translate(context_, picture.corner.x(), picture.corner.y());
  cairo_new_path(context_);
  cairo_rectangle(context_, 0.0, 0.0, picture.width, picture.height);
  cairo_clip(context_);
  cairo_scale(context_, picture.width / image.width, picture.height / image.height);
  cairo_set_source_surface(context_, surface.get(), 0.0, 0.0);
  cairo_pattern_t* const pattern = cairo_get_source(context_);
  cairo_pattern_set_filter(pattern, picture.is_smooth ? CAIRO_FILTER_GOOD : CAIRO_FILTER_NEAREST);
  if (cairo_surface_get_type(cairo_get_target(context_)) == CAIRO_SURFACE_TYPE_IMAGE) {
    cairo_pattern_set_extend(pattern, CAIRO_EXTEND_PAD);  // no half-transparent rim if it is enlarged
  }
  cairo_paint(context_);
  cairo_restore(context_);
}

void CairoPainter::operator()(const shape::ClipBegin& clip) {
  cairo_save(context_);
  cairo_new_path(context_);  // drops the path of the previous shape
  cairo_rectangle(context_, clip.corner.x(), clip.corner.y(), clip.width, clip.height);
  cairo_clip(context_);
  ++open_clips_;
}

void CairoPainter::operator()(const shape::ClipEnd& /*clip*/) {
  if (open_clips_ == 0) return;
  cairo_restore(context_);
  --open_clips_;
}

double text_width(std::string_view words, double size, bool is_bold) {
  cairo_text_extents_t extents;
  cairo_scaled_font_text_extents(measured_font(is_bold), legible(words).c_str(), &extents);
  return extents.x_advance * size / kMeasured_px;
}

std::string shortened(const std::string& words, double size, double room, bool is_bold) {
  if (text_width(words, size, is_bold) <= room) return words;
  const std::string dots = "\xE2\x80\xA6";
  std::string cut = words;
  while (!cut.empty() && text_width(cut + dots, size, is_bold) > room) {
    // Removes whole letters: continuation bytes with their first byte.
    while (cut.size() > 1 && (static_cast<unsigned char>(cut.back()) & 0xC0U) == 0x80U) cut.pop_back();
    cut.pop_back();
  }
  return cut + dots;
}

std::string shortened_within(const std::string& words, double size, double room, std::size_t kept) {
  if (text_width(words, size) <= room) return words;
  std::string tail = words.substr(words.size() - std::min(kept, words.size()));
  const std::string name = words.substr(0, words.size() - tail.size());
  if (text_width(tail, size) > room * 2.0 / 3.0) tail.clear();
  std::vector<std::string_view> letters;
  for (std::size_t at = 0; at < name.size();) letters.push_back(next_letter(name, at).bytes);
  const auto with_letters = [&](std::size_t count) {
    std::string text;
    for (std::size_t k = 0; k < (count + 1) / 2; ++k) text += letters[k];
    if (count < letters.size()) text += "\xE2\x80\xA6";
    for (std::size_t k = letters.size() - count / 2; k < letters.size(); ++k) text += letters[k];
    return text + tail;
  };
  std::size_t fits = 0;  // number of letters that fit
  std::size_t least_beyond = letters.size() + 1;
  while (fits + 1 < least_beyond) {
    const std::size_t count = fits + (least_beyond - fits) / 2;
    (text_width(with_letters(count), size) <= room ? fits : least_beyond) = count;
  }
  return with_letters(fits);
}

}  // namespace gdtslam

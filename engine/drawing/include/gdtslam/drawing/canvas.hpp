// Vector drawings: shapes, words and pictures in drawing order. Cairo turns them into PNG pixels, SVG and PDF. Pixels,
// x right, y down, all finite. One object belongs to one thread; O(shapes).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam {

/// A rectangle of the page, pixels.
struct DrawingArea {
  Point2 corner = Point2::Zero();  ///< upper left
  double width = 0.0;
  double height = 0.0;
};

/// Stroke of a line or an edge.
struct Pen {
  Colour colour = ink::kText;
  double width = 1.0;
  double opacity = 1.0;
  std::string_view dashes = "";  ///< pattern as in SVG, "4 3"; static storage
};

enum class Anchor : std::uint8_t { kStart, kMiddle, kEnd };

/// Farthest drawable coordinate, in pixels: Cairo's coordinates end at 2^23.
inline constexpr double kFarthest_px = 1e6;

/// Style of words.
struct Lettering {
  double size = 13.0;
  Colour colour = ink::kText;
  Anchor anchor = Anchor::kStart;
  bool is_bold = false;
  bool has_halo = false;  ///< a border in the paper's colour around the letters, for words over lines
  Colour halo = ink::kCard;
};

/// Style of a filled area.
struct Fill {
  Colour colour = ink::kCard;
  double opacity = 1.0;
};

/// The shapes of a canvas, one for each call.
namespace shape {
/// A rectangle; its corners are rounded if the radius is not 0.
struct Rectangle {
  Point2 corner;  ///< upper left
  double width = 0.0;
  double height = 0.0;
  double radius = 0.0;
  std::optional<Fill> fill;
  std::optional<Pen> edge;
};
/// A line through points.
struct Line {
  std::vector<Point2> points;
  Pen pen;
};
/// A filled area between points.
struct Polygon {
  std::vector<Point2> points;
  Fill fill;
};
/// A disc, a ring or both.
struct Circle {
  Point2 centre;
  double radius = 0.0;
  std::optional<Fill> fill;
  std::optional<Pen> edge;
};
/// One line of text.
struct Words {
  Point2 at;  ///< on the base line
  std::string text;
  Lettering lettering;
  bool is_upright = false;  ///< rotated by a quarter turn, read from bottom to top
};
/// An image, drawn to a size.
struct Picture {
  Point2 corner;
  double width = 0.0;
  double height = 0.0;
  std::shared_ptr<const RgbaImage> image;
  bool is_smooth = true;  ///< false: each pixel of the image stays a sharp square, as for a map's cells
};
/// Shapes up to the matching ClipEnd are visible only within the rectangle.
struct ClipBegin {
  Point2 corner;
  double width = 0.0;
  double height = 0.0;
};
struct ClipEnd {};
}  // namespace shape
using Shape = std::variant<shape::Rectangle, shape::Line, shape::Polygon, shape::Circle, shape::Words, shape::Picture,
                           shape::ClipBegin, shape::ClipEnd>;

/// A list of shapes in drawing order.
class Canvas {
 public:
  /// The title of an SVG is for screen readers. No page is drawn, so uncovered parts stay transparent.
  Canvas(double width, double height, std::string_view title);

  void rectangle(const Point2& corner, double width, double height, const std::optional<Fill>& fill,
                 const std::optional<Pen>& edge = std::nullopt, double radius = 0.0);
  void line(const Point2& from, const Point2& to, const Pen& pen);
  void polyline(std::vector<Point2> points, const Pen& pen);
  void polygon(std::vector<Point2> points, const Fill& fill);
  void circle(const Point2& centre, double radius, const std::optional<Fill>& fill,
              const std::optional<Pen>& edge = std::nullopt);
  /// Invalid UTF-8 becomes U+FFFD, control characters become spaces.
  void text(const Point2& at, std::string_view words, const Lettering& lettering = {});
  void upright_text(const Point2& at, std::string_view words, const Lettering& lettering = {});
  void picture(const Point2& corner, double width, double height, std::shared_ptr<const RgbaImage> image,
               bool is_smooth = true);
  void begin_clip(const Point2& corner, double width, double height);
  void end_clip();
  /// Adds all shapes of another drawing, scaled and then moved; dashes keep their length.
  void place(const Canvas& drawing, const Point2& corner, double scale = 1.0);

  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] const std::string& title() const { return title_; }
  [[nodiscard]] const std::vector<Shape>& shapes() const { return shapes_; }

 private:
  double width_;
  double height_;
  std::string title_;
  std::vector<Shape> shapes_;
};

/// Width of a line of words in Cairo's font.
double text_width(std::string_view words, double size, bool is_bold = false);

// Drawings as pixels, SVG and PDF, by Cairo: no display, no OpenGL. Thread-safe; O(pixels + shapes). All throw
// UnavailableError if the drawing has words and there is no font, and Error if Cairo fails.

/// `scale` pixels per pixel of the drawing. Also throws Error for a side outside of 1 to 32767 pixels.
RgbaImage rasterise(const Canvas& drawing, double scale = 1.0);
/// Letters are outlines; the description repeats the words for screen readers and searches. The same drawing and fonts
/// give the same bytes.
std::string draw_svg(const Canvas& drawing);
/// One page at 96 pixels per inch with words as text. The same drawing gives the same bytes (no time of day).
std::string draw_pdf(const Canvas& drawing);

}  // namespace gdtslam

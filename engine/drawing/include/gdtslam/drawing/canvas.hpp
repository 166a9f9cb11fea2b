// Vector drawings: shapes, words and pictures in the order in which they are drawn. Cairo makes PNG pixels, SVG and PDF
// of them. Pixels, x right, y down, all of them finite. One object belongs to one thread; O(shapes).
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

/// How a line or an edge is drawn.
struct Pen {
  Colour colour = ink::kText;
  double width = 1.0;
  double opacity = 1.0;
  std::string_view dashes = "";  ///< pattern in the form of SVG, "4 3"; of static storage
};

enum class Anchor : std::uint8_t { kStart, kMiddle, kEnd };

/// Farthest place from the origin that is drawn, in pixels: Cairo's coordinates end at 2^23.
inline constexpr double kFarthest_px = 1e6;

/// How words are drawn.
struct Lettering {
  double size = 13.0;
  Colour colour = ink::kText;
  Anchor anchor = Anchor::kStart;
  bool is_bold = false;
  bool has_halo = false;  ///< the paper's colour around the letters, over lines
  Colour halo = ink::kCard;
};

/// How an area is filled.
struct Fill {
  Colour colour = ink::kCard;
  double opacity = 1.0;
};

/// The records of a canvas, one for each call.
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
  bool is_upright = false;  ///< turned by a quarter, to be read from below
};
/// An image, drawn to a size.
struct Picture {
  Point2 corner;
  double width = 0.0;
  double height = 0.0;
  std::shared_ptr<const RgbaImage> image;
  bool is_smooth = true;  ///< false: each pixel of the image stays a square, as a map's cells should
};
/// Shapes from here to the matching ClipEnd are seen within the rectangle only.
struct ClipBegin {
  Point2 corner;
  double width = 0.0;
  double height = 0.0;
};
struct ClipEnd {};
}  // namespace shape
using Shape = std::variant<shape::Rectangle, shape::Line, shape::Polygon, shape::Circle, shape::Words, shape::Picture,
                           shape::ClipBegin, shape::ClipEnd>;

/// A drawing, shape upon shape.
class Canvas {
 public:
  /// A screen reader reads the title of an SVG. No page is drawn, so uncovered parts stay transparent.
  Canvas(double width, double height, std::string_view title);

  void rectangle(const Point2& corner, double width, double height, const std::optional<Fill>& fill,
                 const std::optional<Pen>& edge = std::nullopt, double radius = 0.0);
  void line(const Point2& from, const Point2& to, const Pen& pen);
  void polyline(std::vector<Point2> points, const Pen& pen);
  void polygon(std::vector<Point2> points, const Fill& fill);
  void circle(const Point2& centre, double radius, const std::optional<Fill>& fill,
              const std::optional<Pen>& edge = std::nullopt);
  /// Bytes that are not UTF-8 become U+FFFD, control characters become spaces.
  void text(const Point2& at, std::string_view words, const Lettering& lettering = {});
  void upright_text(const Point2& at, std::string_view words, const Lettering& lettering = {});
  void picture(const Point2& corner, double width, double height, std::shared_ptr<const RgbaImage> image,
               bool is_smooth = true);
  void begin_clip(const Point2& corner, double width, double height);
  void end_clip();
  /// All shapes of another drawing, scaled and then moved; dashes keep their length.
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

/// Width of a line of words in the face that Cairo draws with.
double text_width(std::string_view words, double size, bool is_bold = false);

// Drawings as pixels, SVG and PDF, by Cairo: no display, no OpenGL. Thread-safe; O(pixels + shapes). All throw
// UnavailableError if the drawing has words and there is no font, and Error if Cairo fails.

/// `scale` pixels for each pixel of the drawing. Throws Error too for a side that has not 1 to 32767 pixels.
RgbaImage rasterise(const Canvas& drawing, double scale = 1.0);
/// Letters are outlines; the words stand in the description, for screen readers and searches. The same bytes for the
/// same drawing and fonts.
std::string draw_svg(const Canvas& drawing);
/// One page, 96 pixels an inch, words stay words. The same bytes for the same drawing (no time of day).
std::string draw_pdf(const Canvas& drawing);

}  // namespace gdtslam

#include "gdtslam/drawing/canvas.hpp"

#include <cassert>
#include <type_traits>
#include <utility>

#include "letters.hpp"

namespace gdtslam {
namespace {

Point2 moved(const Point2& point, const Point2& by) { return {point.x() + by.x(), point.y() + by.y()}; }

void move(Shape& shape, const Point2& by) {
  std::visit(
      [&by](auto& what) {
        using What = std::decay_t<decltype(what)>;
        if constexpr (std::is_same_v<What, shape::Line> || std::is_same_v<What, shape::Polygon>) {
          for (Point2& point : what.points) point = moved(point, by);
        } else if constexpr (std::is_same_v<What, shape::Circle>) {
          what.centre = moved(what.centre, by);
        } else if constexpr (std::is_same_v<What, shape::Words>) {
          what.at = moved(what.at, by);
        } else if constexpr (!std::is_same_v<What, shape::ClipEnd>) {
          what.corner = moved(what.corner, by);
        }
      },
      shape);
}

}  // namespace

Canvas::Canvas(double width, double height, std::string_view title)
    : width_(width), height_(height), title_(legible(title)) {}

void Canvas::rectangle(const Point2& corner, double width, double height, const std::optional<Fill>& fill,
                       const std::optional<Pen>& edge, double radius) {
  shapes_.emplace_back(shape::Rectangle{corner, width, height, radius, fill, edge});
}

void Canvas::line(const Point2& from, const Point2& to, const Pen& pen) {
  shapes_.emplace_back(shape::Line{{from, to}, pen});
}

void Canvas::polyline(std::vector<Point2> points, const Pen& pen) {
  shapes_.emplace_back(shape::Line{std::move(points), pen});
}

void Canvas::polygon(std::vector<Point2> points, const Fill& fill) {
  shapes_.emplace_back(shape::Polygon{std::move(points), fill});
}

void Canvas::circle(const Point2& centre, double radius, const std::optional<Fill>& fill,
                    const std::optional<Pen>& edge) {
  shapes_.emplace_back(shape::Circle{centre, radius, fill, edge});
}

void Canvas::text(const Point2& at, std::string_view words, const Lettering& lettering) {
  shapes_.emplace_back(shape::Words{at, legible(words), lettering, false});
}

void Canvas::upright_text(const Point2& at, std::string_view words, const Lettering& lettering) {
  shapes_.emplace_back(shape::Words{at, legible(words), lettering, true});
}

void Canvas::picture(const Point2& corner, double width, double height, std::shared_ptr<const RgbaImage> image,
                     bool is_smooth) {
  assert(image != nullptr);
  shapes_.emplace_back(shape::Picture{corner, width, height, std::move(image), is_smooth});
}

void Canvas::begin_clip(const Point2& corner, double width, double height) {
  shapes_.emplace_back(shape::ClipBegin{corner, width, height});
}

void Canvas::end_clip() { shapes_.emplace_back(shape::ClipEnd{}); }

void Canvas::place(const Canvas& drawing, const Point2& corner) {
  for (Shape shape : drawing.shapes_) {
    move(shape, corner);
    shapes_.push_back(std::move(shape));
  }
}

}  // namespace gdtslam

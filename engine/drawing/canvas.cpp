#include "gdtslam/drawing/canvas.hpp"

#include <cassert>
#include <optional>
#include <utility>

#include "letters.hpp"

namespace gdtslam {
namespace {

/// Scales a shape, then moves it.
struct Placing {
  Point2 corner;
  double scale = 1.0;

  void place(Point2& point) const { point = corner + scale * point; }
  void place(Pen& pen) const { pen.width *= scale; }
  void place(std::optional<Pen>& pen) const {
    if (pen) place(*pen);
  }
  void operator()(shape::Line& line) const {
    for (Point2& point : line.points) place(point);
    place(line.pen);
  }
  void operator()(shape::Polygon& polygon) const {
    for (Point2& point : polygon.points) place(point);
  }
  void operator()(shape::Circle& circle) const {
    place(circle.centre);
    circle.radius *= scale;
    place(circle.edge);
  }
  void operator()(shape::Words& words) const {
    place(words.at);
    words.lettering.size *= scale;
  }
  void operator()(shape::Rectangle& box) const {
    place_box(box);
    box.radius *= scale;
    place(box.edge);
  }
  void operator()(shape::Picture& picture) const { place_box(picture); }
  void operator()(shape::ClipBegin& clip) const { place_box(clip); }
  void operator()(shape::ClipEnd& /*clip*/) const {}
  template <class Box>
  void place_box(Box& box) const {
    place(box.corner);
    box.width *= scale;
    box.height *= scale;
  }
};

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

void Canvas::place(const Canvas& drawing, const Point2& corner, double scale) {
  for (Shape shape : drawing.shapes_) {
    std::visit(Placing{corner, scale}, shape);
    shapes_.push_back(std::move(shape));
  }
}

}  // namespace gdtslam

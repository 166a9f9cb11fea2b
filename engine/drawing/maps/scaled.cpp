#include "scaled.hpp"

#include <optional>
#include <vector>

namespace gdtslam::picture {
namespace {

struct Scaling {
  Canvas& canvas;
  double unit;

  [[nodiscard]] Pen of(Pen pen) const {
    pen.width *= unit;
    return pen;
  }
  [[nodiscard]] std::optional<Pen> of(const std::optional<Pen>& pen) const {
    return pen ? std::optional<Pen>(of(*pen)) : std::nullopt;
  }
  [[nodiscard]] std::vector<Point2> of(std::vector<Point2> points) const {
    for (Point2& point : points) point *= unit;
    return points;
  }

  void operator()(const shape::Rectangle& what) const {
    canvas.rectangle(what.corner * unit, what.width * unit, what.height * unit, what.fill, of(what.edge),
                     what.radius * unit);
  }
  void operator()(const shape::Line& what) const { canvas.polyline(of(what.points), of(what.pen)); }
  void operator()(const shape::Polygon& what) const { canvas.polygon(of(what.points), what.fill); }
  void operator()(const shape::Circle& what) const {
    canvas.circle(what.centre * unit, what.radius * unit, what.fill, of(what.edge));
  }
  void operator()(const shape::Words& what) const {
    Lettering lettering = what.lettering;
    lettering.size *= unit;
    if (what.is_upright) {
      canvas.upright_text(what.at * unit, what.text, lettering);
    } else {
      canvas.text(what.at * unit, what.text, lettering);
    }
  }
  void operator()(const shape::Picture& what) const {
    canvas.picture(what.corner * unit, what.width * unit, what.height * unit, what.image, what.is_smooth);
  }
  void operator()(const shape::ClipBegin& what) const {
    canvas.begin_clip(what.corner * unit, what.width * unit, what.height * unit);
  }
  void operator()(const shape::ClipEnd& /*what*/) const { canvas.end_clip(); }
};

}  // namespace

Canvas scaled(const Canvas& drawing, double unit, const PictureSize& size) {
  Canvas canvas(size.width, size.height, drawing.title());
  const Scaling scaling{canvas, unit};
  for (const Shape& shape : drawing.shapes()) std::visit(scaling, shape);
  return canvas;
}

}  // namespace gdtslam::picture

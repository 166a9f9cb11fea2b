#include "simplex_moves.hpp"

namespace gdtslam::optimize {

Point centre_of(std::span<const Valued> vertices) {
  const std::size_t n = vertices.size() - 1;
  Point centre(vertices.front().point.size(), 0.0);
  for (std::size_t k = 0; k < centre.size(); ++k) {
    for (std::size_t i = 0; i < n; ++i) centre[k] += vertices[i].point[k];
    centre[k] /= static_cast<double>(n);
  }
  return centre;
}

Point along(const Point& centre, const Point& worst, double factor) {
  Point point(centre.size());
  for (std::size_t k = 0; k < point.size(); ++k) point[k] = centre[k] + factor * (worst[k] - centre[k]);
  return point;
}

std::vector<Valued> first_simplex(const Counted& function, const Point& start, std::span<const double> steps) {
  std::vector<Valued> vertices(start.size() + 1, Valued{start, 0.0});
  for (std::size_t k = 0; k < start.size(); ++k) {
    const double step = steps.empty() ? 0.1 * function.width(k) : steps[k];
    double& coordinate = vertices[k + 1].point[k];
    coordinate += coordinate + step <= function.box().most[k] ? step : -step;
    vertices[k + 1].point = function.clamped(vertices[k + 1].point);
  }
  return vertices;
}

void shrink(Counted& function, std::span<Valued> vertices) {
  for (Valued& vertex : vertices.subspan(1)) vertex.point = along(vertices.front().point, vertex.point, 0.5);
  function.evaluate(vertices.subspan(1));
}

}  // namespace gdtslam::optimize

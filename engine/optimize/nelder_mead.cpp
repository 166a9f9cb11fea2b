#include <algorithm>
#include <limits>

#include "gdtslam/core/error.hpp"
#include "nelder_mead.hpp"
#include "simplex_moves.hpp"

namespace gdtslam::optimize {
namespace {

bool is_small(const Counted& function, std::span<const Valued> vertices, const NelderMead& method) {
  for (std::size_t k = 0; k < function.dimensions(); ++k) {
    const double tolerance = method.tolerances.empty() ? 1e-6 * function.width(k) : method.tolerances[k];
    if (extent(vertices, k) > tolerance) return false;
  }
  return true;
}

// Beyond the box a point is worth nothing and is not valued. Drawing it onto a face would flatten the simplex there.
Valued tried(Counted& function, const Point& centre, const Point& worst, double factor) {
  Valued one{along(centre, worst, factor), std::numeric_limits<double>::infinity()};
  if (function.holds(one.point)) one.value = function.evaluate(one.point);
  return one;
}

// One move: the worst vertex is replaced, or all but the best are drawn to it.
void move(Counted& function, std::vector<Valued>& vertices) {
  const Point centre = centre_of(vertices);
  const Valued worst = vertices.back();
  const Valued reflected = tried(function, centre, worst.point, -1.0);
  if (is_better(reflected, vertices.front())) {
    const Valued expanded = tried(function, centre, worst.point, -2.0);
    vertices.back() = is_better(expanded, reflected) ? expanded : reflected;
    return;
  }
  if (is_better(reflected, vertices[vertices.size() - 2])) {
    vertices.back() = reflected;
    return;
  }
  const bool is_outside = is_better(reflected, worst);
  const Valued contracted = tried(function, centre, worst.point, is_outside ? -0.5 : 0.5);
  if (is_better(contracted, is_outside ? reflected : worst)) {
    vertices.back() = contracted;
  } else {
    shrink(function, vertices);
  }
}

}  // namespace

void descend(Counted& function, std::vector<Valued>& vertices, const NelderMead& method) {
  std::stable_sort(vertices.begin(), vertices.end(), is_better);
  while (!function.must_stop() && !is_small(function, vertices, method)) {
    move(function, vertices);
    std::stable_sort(vertices.begin(), vertices.end(), is_better);
  }
}

Minimum minimise(Function& function, const Box& box, std::span<const double> start, const NelderMead& method,
                 const Limits& limits) {
  Counted counted(function, box, start, limits);
  for (const std::vector<double>* given : {&method.steps, &method.tolerances}) {
    if (!given->empty() && given->size() != start.size())
      throw ConfigError("minimise: one step and tolerance a dimension");
  }
  std::vector<Valued> vertices = first_simplex(counted, counted.start(), method.steps);
  counted.evaluate(vertices);
  descend(counted, vertices, method);
  return counted.result();
}

}  // namespace gdtslam::optimize

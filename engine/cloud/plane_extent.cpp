#include "plane_extent.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kMostNodes = 4e6;
constexpr double kStepsOfGap = 8.0;

PlanePoint turned(const PlanePoint& point, const SinCos<double>& turn) {
  return {turn.cos * point[0] + turn.sin * point[1], turn.cos * point[1] - turn.sin * point[0]};
}

double box_area_m2(std::span<const PlanePoint> points, double turn_rad) {
  const SinCos<double> turn = sin_cos(turn_rad);
  PlaneBox box{turned(points.front(), turn), turned(points.front(), turn)};
  for (const PlanePoint& point : points) {
    const PlanePoint at = turned(point, turn);
    for (const std::size_t axis : {0U, 1U}) {
      box.low[axis] = std::min(box.low[axis], at[axis]);
      box.high[axis] = std::max(box.high[axis], at[axis]);
    }
  }
  return box.length_m(0) * box.length_m(1);
}

// Nodes of a grid, each seen or not, in rows.
struct Nodes {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint8_t> is_seen;
  [[nodiscard]] std::size_t index(std::size_t column, std::size_t row) const { return row * width + column; }
};

// Along one line of `count` nodes, `stride` apart: a node becomes `value` where one within `reach` of it is.
void spread_line(std::uint8_t* line, std::size_t count, std::size_t stride, std::size_t reach, std::uint8_t value,
                 std::vector<std::uint8_t>& was) {
  was.resize(count);
  for (std::size_t k = 0; k < count; ++k) was[k] = line[k * stride];
  std::size_t until = 0;  // nodes below it are `value` by one before them
  for (std::size_t k = 0; k < count; ++k) {
    if (was[k] != value) continue;
    const std::size_t end = std::min(count, k + reach + 1);
    for (std::size_t n = std::max(until, k - std::min(k, reach)); n < end; ++n) line[n * stride] = value;
    until = end;
  }
}

void spread(Nodes& nodes, std::size_t reach, std::uint8_t value) {
  std::vector<std::uint8_t> was;
  for (std::size_t row = 0; row < nodes.height; ++row) {
    spread_line(nodes.is_seen.data() + nodes.index(0, row), nodes.width, 1, reach, value, was);
  }
  for (std::size_t column = 0; column < nodes.width; ++column) {
    spread_line(nodes.is_seen.data() + column, nodes.height, nodes.width, reach, value, was);
  }
}

// Squares whose four corners are seen: a row of n + 1 nodes is n squares long, as the points that are its ends are.
std::size_t whole_squares(const Nodes& nodes) {
  std::size_t count = 0;
  for (std::size_t row = 0; row + 1 < nodes.height; ++row) {
    for (std::size_t column = 0; column + 1 < nodes.width; ++column) {
      const std::uint8_t* const corner = nodes.is_seen.data() + nodes.index(column, row);
      count += static_cast<std::size_t>(corner[0] & corner[1] & corner[nodes.width] & corner[nodes.width + 1]);
    }
  }
  return count;
}

}  // namespace

PlaneAxes plane_axes(const Point3& normal, bool is_level) {
  const Point3 along = (is_level ? Point3::UnitY() : Point3::UnitZ()).cross(normal).normalized();
  return {along, normal.cross(along).normalized()};
}

PlaneBox box_around(std::span<const PlanePoint> points) {
  PlaneBox box{points.front(), points.front()};
  for (const PlanePoint& point : points) {
    for (const std::size_t axis : {0U, 1U}) {
      box.low[axis] = std::min(box.low[axis], point[axis]);
      box.high[axis] = std::max(box.high[axis], point[axis]);
    }
  }
  return box;
}

// Every degree of a quarter turn, then ever finer about the best.
std::vector<PlanePoint> turned_into_smallest_box(std::span<const PlanePoint> points) {
  double best_rad = 0.0;
  double best_m2 = box_area_m2(points, 0.0);
  const auto try_about = [&](double middle_rad, double step_rad, int steps) {
    for (int k = -steps; k <= steps; ++k) {
      const double turn_rad = middle_rad + k * step_rad;
      const double area_m2 = box_area_m2(points, turn_rad);
      if (area_m2 >= best_m2) continue;
      best_m2 = area_m2;
      best_rad = turn_rad;
    }
  };
  try_about(0.0, rad_from_deg(1.0), 45);
  for (const double step_deg : {0.1, 0.01}) try_about(best_rad, rad_from_deg(step_deg), 10);
  std::vector<PlanePoint> all;
  all.reserve(points.size());
  const SinCos<double> turn = sin_cos(best_rad);
  for (const PlanePoint& point : points) all.push_back(turned(point, turn));
  const PlaneBox box = box_around(all);
  if (box.length_m(1) > box.length_m(0)) {
    for (PlanePoint& point : all) point = {point[1], -point[0]};
  }
  return all;
}

double area_of_points_m2(std::span<const PlanePoint> points, double gap_m) {
  const PlaneBox box = box_around(points);
  const double step_m = std::max(gap_m / kStepsOfGap, std::sqrt(box.length_m(0) * box.length_m(1) / kMostNodes));
  const auto reach = static_cast<std::size_t>(std::lround(0.5 * gap_m / step_m));
  const std::size_t border = reach + 1;  // border that stays empty when the points have spread
  const auto node = [&](const PlanePoint& point, std::size_t axis) {
    return border + static_cast<std::size_t>(std::lround((point[axis] - box.low[axis]) / step_m));
  };
  Nodes nodes{.width = node(box.high, 0) + border + 1, .height = node(box.high, 1) + border + 1, .is_seen = {}};
  nodes.is_seen.assign(nodes.width * nodes.height, 0);
  for (const PlanePoint& point : points) nodes.is_seen[nodes.index(node(point, 0), node(point, 1))] = 1;
  spread(nodes, reach, 1);
  spread(nodes, reach, 0);
  return static_cast<double>(whole_squares(nodes)) * step_m * step_m;
}

}  // namespace gdtslam

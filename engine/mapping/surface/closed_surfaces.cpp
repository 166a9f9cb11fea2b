#include "closed_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace gdtslam {
namespace {

constexpr double kWidestGap_m = 2.0;
constexpr double kNeighbours = 1.5;  // usual angles between beams: more and a beam in between returned nothing
constexpr double kLineNoise_m = 0.02;
constexpr double kLineShare = 0.05;  // distance from the line as a share of the distance to the next point

constexpr double kLone_m = 0.5;

double length(double x, double y) { return std::sqrt(x * x + y * y); }

// Sine of the angle between the beams of two returns.
double sine_between(const Point2& a, const Point2& b) {
  const double product = length(a.x(), a.y()) * length(b.x(), b.y());
  return product > 0.0 ? std::fabs(a.x() * b.y() - a.y() * b.x()) / product : 1.0;
}

double usual_sine(std::span<const Point2> points) {
  std::vector<double> sines;
  for (std::size_t i = 1; i < points.size(); ++i) sines.push_back(sine_between(points[i - 1], points[i]));
  const auto middle = sines.begin() + static_cast<std::ptrdiff_t>(sines.size() / 2);
  std::nth_element(sines.begin(), middle, sines.end());
  return *middle;
}

bool are_neighbours(std::span<const Point2> points, double usual_sine) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (sine_between(points[i - 1], points[i]) > kNeighbours * usual_sine) return false;
  }
  return true;
}

// Whether the first and the last of four points lie on the line through the others, none far from the next.
bool are_on_a_line(std::span<const Point2> points) {
  const Point2 gap = points[2] - points[1];
  const double gap_m = length(gap.x(), gap.y());
  if (!(gap_m > 0.0) || gap_m > kWidestGap_m) return false;
  const auto is_on_line = [&](const Point2& point, const Point2& next) {
    const Point2 off = point - next;
    const double away_m = length(off.x(), off.y());
    const double beside_m = std::fabs(off.x() * gap.y() - off.y() * gap.x()) / gap_m;
    return away_m <= kWidestGap_m && beside_m <= std::max(kLineNoise_m, kLineShare * away_m);
  };
  return is_on_line(points[0], points[1]) && is_on_line(points[3], points[2]);
}

}  // namespace

std::vector<Point2> with_surfaces_closed(std::span<const Point2> points_base_m, double spacing_m) {
  constexpr std::size_t kInARow = 4;
  std::vector<Point2> closed(points_base_m.begin(), points_base_m.end());
  if (points_base_m.size() < kInARow) return closed;
  const double sine = usual_sine(points_base_m);
  for (std::size_t i = 0; i + kInARow <= points_base_m.size(); ++i) {
    const std::span<const Point2> row = points_base_m.subspan(i, kInARow);
    if (!are_neighbours(row, sine) || !are_on_a_line(row)) continue;
    const Point2 gap = row[2] - row[1];
    const auto pieces = static_cast<int>(length(gap.x(), gap.y()) / spacing_m) + 1;
    for (int k = 1; k < pieces; ++k) closed.push_back(row[1] + static_cast<double>(k) / pieces * gap);
  }
  return closed;
}

std::optional<Point2> lone_on_wall(std::span<const Point2> points_base_m, std::size_t at) {
  const std::size_t count = points_base_m.size();
  const auto is_near = [&](std::size_t other) { return (points_base_m[at] - points_base_m[other]).norm() < kLone_m; };
  if ((at > 0 && is_near(at - 1)) || (at + 1 < count && is_near(at + 1))) return std::nullopt;
  for (const std::size_t before : {1U, 2U, 0U}) {  // offsets of a triple: the three neighbours before this point
    if (at < before || at - before + 2 >= count) continue;
    const Point2& first = points_base_m[at - before];
    const Point2 chord = points_base_m[at - before + 2] - first;
    const Point2 middle = points_base_m[at - before + 1] - first;
    const double far_m = std::max(middle.norm(), (chord - middle).norm());
    const double aside_m = std::fabs(middle.x() * chord.y() - middle.y() * chord.x()) / chord.norm();
    if (aside_m < std::max(kLineNoise_m, kLineShare * far_m)) return chord / chord.norm();
  }
  return std::nullopt;
}

}  // namespace gdtslam

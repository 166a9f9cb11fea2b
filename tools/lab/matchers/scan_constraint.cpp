#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "run.hpp"

namespace gdtslam {
namespace {

constexpr double kReach_m = 0.25;
constexpr std::ptrdiff_t kBeams = 8;
constexpr int kLeastNeighbours = 2;

struct Normal {
  double x = 0.0;
  double y = 0.0;
};

/// Sums over a point's neighbours, relative to the point.
struct Spread {
  int count = 0;
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  void add(double dx, double dy) {
    ++count;
    x += dx;
    y += dy;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
};

// The minor axis of the spread: eigenvector of the smaller eigenvalue.
Normal spread_normal(const Spread& s) {
  const double n = s.count;
  const double a = s.xx - s.x * s.x / n;
  const double b = s.xy - s.x * s.y / n;
  const double c = s.yy - s.y * s.y / n;
  const double half = 0.5 * (a - c);
  const double root = std::sqrt(half * half + b * b);
  // Both formulas give the same vector; this choice has no cancellation.
  Normal along = half >= 0.0 ? Normal{half + root, b} : Normal{b, root - half};
  const double length = std::sqrt(along.x * along.x + along.y * along.y);
  if (!(length > 0.0)) return {0.0, 0.0};
  return {-along.y / length, along.x / length};
}

std::optional<Normal> normal_at(std::span<const PointCells> points, std::ptrdiff_t i, double reach_cells) {
  const auto size = static_cast<std::ptrdiff_t>(points.size());
  const PointCells& at = points[static_cast<std::size_t>(i)];
  Spread spread;
  for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(i - kBeams, 0); k < std::min(i + kBeams + 1, size); ++k) {
    const PointCells& other = points[static_cast<std::size_t>(k)];
    const double dx = static_cast<double>(other.x) - static_cast<double>(at.x);
    const double dy = static_cast<double>(other.y) - static_cast<double>(at.y);
    if (dx * dx + dy * dy <= reach_cells * reach_cells) spread.add(dx, dy);
  }
  if (spread.count <= kLeastNeighbours) return std::nullopt;
  return spread_normal(spread);
}

}  // namespace

std::array<double, 6> line_information(std::span<const PointCells> points, double resolution_m) {
  std::array<double, 6> sums{};
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(points.size()); ++i) {
    const std::optional<Normal> normal = normal_at(points, i, kReach_m / resolution_m);
    if (!normal) continue;
    const PointCells& p = points[static_cast<std::size_t>(i)];
    const double turn = normal->y * static_cast<double>(p.x) - normal->x * static_cast<double>(p.y);
    sums[0] += normal->x * normal->x;
    sums[1] += normal->x * normal->y;
    sums[2] += normal->x * turn;
    sums[3] += normal->y * normal->y;
    sums[4] += normal->y * turn;
    sums[5] += turn * turn;
  }
  return sums;
}

double constraint_strength(const std::array<double, 6>& information) {
  const auto& [xx, xy, xt, yy, yt, tt] = information;
  if (!(tt > 0.0)) return 0.0;
  const double a = xx - xt * xt / tt;
  const double b = xy - xt * yt / tt;
  const double c = yy - yt * yt / tt;
  const double middle = 0.5 * (a + c);
  const double spread = std::sqrt(0.25 * (a - c) * (a - c) + b * b);
  const double most = middle + spread;
  return most > 0.0 ? std::max(0.0, middle - spread) / most : 0.0;
}

}  // namespace gdtslam

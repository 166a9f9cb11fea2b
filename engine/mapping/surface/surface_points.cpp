#include "surface_points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostNeighbours = 8;  // on each side
constexpr std::size_t kFewestPoints = 4;
constexpr double kReachShare = 0.05;  // of the range: neighbours at a grazing angle lie far apart
constexpr double kReachNexts = 3.5;   // and of the next point's distance: beams may be few
constexpr double kLeastReach_m = 0.12;
constexpr double kMostReach_m = 0.5;
constexpr double kFlatness = 0.05;       // most of the variance across, as a share of that along
constexpr double kRoughness_m = 0.01;    // and beyond that share: a laser's noise
constexpr double kLonePlace_m = 0.5;     // beams that have no neighbours are about so far apart
constexpr double kMostLone = 20.0;       // that tell something new
constexpr double kSurfaceEnough = 20.0;  // points on surfaces, beside which lone ones tell nothing
constexpr double kAcross = 0.5;          // least squared cosine between a normal and the way: 45 degrees
constexpr double kEnoughAcross = 0.1;    // of the surface

// Sums over the neighbours of a point, relative to it.
struct Neighbourhood {
  std::size_t count = 0;
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;

  void add(double dx, double dy) {
    ++count;
    x += dx;
    y += dy;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
};

Neighbourhood neighbourhood_of(std::span<const Point2> points, std::size_t at) {
  const double px = points[at].x();
  const double py = points[at].y();
  const auto away_m = [&](std::size_t other) { return (points[other] - points[at]).norm(); };
  const double next_m = std::min(at > 0 ? away_m(at - 1) : kMostReach_m,  //
                                 at + 1 < points.size() ? away_m(at + 1) : kMostReach_m);
  const double usual_m = kReachShare * std::sqrt(px * px + py * py);
  const double reach_m = std::clamp(std::max(usual_m, kReachNexts * next_m), kLeastReach_m, kMostReach_m);
  Neighbourhood sums;
  sums.add(0.0, 0.0);
  const auto take = [&](std::size_t neighbour) {
    const double dx = points[neighbour].x() - px;
    const double dy = points[neighbour].y() - py;
    if (dx * dx + dy * dy >= reach_m * reach_m) return false;
    sums.add(dx, dy);
    return true;
  };
  for (std::size_t k = 1; k <= kMostNeighbours && k <= at && take(at - k); ++k) continue;
  for (std::size_t k = 1; k <= kMostNeighbours && at + k < points.size() && take(at + k); ++k) continue;
  return sums;
}

// The axis across a flat neighbourhood.
std::optional<Point2> normal_of(const Neighbourhood& sums) {
  if (sums.count < kFewestPoints) return std::nullopt;
  const auto n = static_cast<double>(sums.count);
  const double xx = sums.xx - sums.x * sums.x / n;
  const double xy = sums.xy - sums.x * sums.y / n;
  const double yy = sums.yy - sums.y * sums.y / n;
  const double spread = std::sqrt((xx - yy) * (xx - yy) + 4.0 * xy * xy);
  const double along = 0.5 * (xx + yy + spread);
  const double across = 0.5 * (xx + yy - spread);
  if (!(spread > 0.0) || across > kFlatness * along + n * kRoughness_m * kRoughness_m) return std::nullopt;
  const double angle = 0.5 * atan2(2.0 * xy, xx - yy);
  const auto direction = sin_cos(angle);
  return Point2(-direction.sin, direction.cos);
}

}  // namespace

std::vector<Point2> points_of(const KeptScan& scan) {
  std::vector<Point2> points;
  points.reserve(scan.points());
  for (const SurfacePoint& p : scan.surface) points.push_back(p.point());
  for (const LonePoint& p : scan.lone) points.push_back(p.point());
  return points;
}

KeptScan keep_scan(std::span<const Point2> points_base_m) {
  KeptScan kept;
  for (std::size_t i = 0; i < points_base_m.size(); ++i) {
    const Point2& point = points_base_m[i];
    const auto x = static_cast<float>(point.x());
    const auto y = static_cast<float>(point.y());
    const std::optional<Point2> normal = normal_of(neighbourhood_of(points_base_m, i));
    if (!normal) {
      kept.lone.push_back({x, y});
      continue;
    }
    const double away = normal->x() * point.x() + normal->y() * point.y();
    const double sign = away > 0.0 ? -1.0 : 1.0;
    kept.surface.push_back({x, y, static_cast<float>(sign * normal->x()), static_cast<float>(sign * normal->y()),
                            static_cast<float>(direction_of(point.x(), point.y()))});
  }
  std::stable_sort(kept.surface.begin(), kept.surface.end(),
                   [](const SurfacePoint& a, const SurfacePoint& b) { return a.direction < b.direction; });
  return kept;
}

Matrix3 shape_of(const KeptScan& scan) {
  Matrix3 shape;
  for (const SurfacePoint& p : scan.surface) {
    const double nx = p.normal_x;
    const double ny = p.normal_y;
    const double lever = static_cast<double>(p.x_m) * ny - static_cast<double>(p.y_m) * nx;
    const Tangent2 J{nx, ny, lever};
    shape += outer(J, J);
  }
  return shape;
}

Matrix3 lone_information(const KeptScan& scan) {
  const double missing = std::max(0.0, 1.0 - static_cast<double>(scan.surface.size()) / kSurfaceEnough);
  if (scan.lone.empty() || missing == 0.0) return {};
  Matrix3 sum;
  for (const LonePoint& p : scan.lone) {
    sum += outer(Tangent2{1.0, 0.0, -static_cast<double>(p.y_m)}, Tangent2{1.0, 0.0, -static_cast<double>(p.y_m)});
    sum += outer(Tangent2{0.0, 1.0, static_cast<double>(p.x_m)}, Tangent2{0.0, 1.0, static_cast<double>(p.x_m)});
  }
  const double share = std::min(1.0, kMostLone / static_cast<double>(scan.lone.size()));
  return missing * share / (kLonePlace_m * kLonePlace_m) * sum;
}

bool knows_way(const KeptScan& scan, const Point2& direction) {
  const double length_squared = direction.squaredNorm();
  std::size_t across = 0;
  for (const SurfacePoint& p : scan.surface) {
    const double along = p.normal().dot(direction);
    across += along * along >= kAcross * length_squared ? 1U : 0U;
  }
  return static_cast<double>(across) > kEnoughAcross * static_cast<double>(scan.surface.size());
}

Matrix3 shape_of_one(const Matrix3& shape, std::size_t points, double least, double noise) {
  const double share = points > 0 ? 1.0 / static_cast<double>(points) : 0.0;
  return with_eigenvalues(eigen_of_symmetric(share * shape),
                          [=](double value) { return std::max(least, value - noise); });
}

}  // namespace gdtslam

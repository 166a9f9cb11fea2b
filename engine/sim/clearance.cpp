#include "clearance.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "surface_distance.hpp"

namespace gdtslam::sim {
namespace {

using Polygon = std::vector<Vec3>;  // convex

// The part of a convex polygon on one side of a height [Sutherland1974].
Polygon clipped(const Polygon& polygon, double height_m, double side) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    const double above_a = side * (a.z() - height_m);
    const double above_b = side * (b.z() - height_m);
    if (above_a >= 0.0) {
      kept.push_back(a);
    }
    if ((above_a > 0.0 && above_b < 0.0) || (above_a < 0.0 && above_b > 0.0)) {
      kept.push_back(a + (b - a) * (above_a / (above_a - above_b)));
    }
  }
  return kept;
}

// The parts of all triangles between the two heights, pressed flat at height 0.
TriangleMesh flattened(const TriangleMesh& mesh, const ClearanceQuery& query) {
  TriangleMesh flat;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::array<Vec3, 3> corners = mesh.corners(i);
    const Polygon band = clipped(clipped({corners.begin(), corners.end()}, query.low_m, 1.0), query.high_m, -1.0);
    const auto first = static_cast<std::uint32_t>(flat.vertices.size());
    for (const Vec3& corner : band) flat.vertices.emplace_back(corner.x(), corner.y(), 0.0);
    // One or two corners, where a triangle only touches a height, are a triangle without area.
    const auto last = static_cast<std::uint32_t>(flat.vertices.size());
    for (std::uint32_t k = first; k < last && (k == first || k + 2 < last); ++k) {
      flat.triangles.push_back({first, std::min(k + 1, last - 1), std::min(k + 2, last - 1)});
    }
  }
  return flat;
}

}  // namespace

std::vector<double> clearances_m(const TriangleMesh& mesh, const ClearanceQuery& query,
                                 const std::vector<Point2>& places_m) {
  std::vector<double> best_m(places_m.size(), query.limit_m);
  TriangleMesh flat = flattened(mesh, query);
  if (flat.triangles.empty()) return best_m;
  const SurfaceDistance obstacles(std::move(flat));
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    best_m[i] = std::min(best_m[i], obstacles.nearest({places_m[i].x(), places_m[i].y(), 0.0}).distance_m);
  }
  return best_m;
}

}  // namespace gdtslam::sim

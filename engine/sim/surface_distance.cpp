#include "surface_distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "embree_boxes.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

double sq_distance_to_segment(const Vec3& point_m, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  const Vec3 offset = point_m - from;
  const double sq_length = along.dot(along);
  const double share = sq_length > 0.0 ? std::clamp(offset.dot(along) / sq_length, 0.0, 1.0) : 0.0;
  const Vec3 rest = offset - share * along;
  return rest.dot(rest);
}

struct SurfaceSearch {
  const TriangleMesh* mesh = nullptr;
  Vec3 point_m{0.0, 0.0, 0.0};
  double sq_best = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = 0;

  /// Keeps this triangle if it is the best so far; returns whether it is.
  bool take(std::uint32_t candidate) {
    const double sq_distance = sq_distance_to_triangle(point_m, mesh->corners(candidate));
    if (std::pair(sq_distance, candidate) >= std::pair(sq_best, triangle)) return false;
    sq_best = sq_distance;
    triangle = candidate;
    return true;
  }
};

bool propose_triangle(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<SurfaceSearch*>(arguments->userPtr);
  if (!search.take(arguments->primID)) return false;
  // The sphere stays a little larger, so that triangles at the same distance are still proposed.
  const auto radius = static_cast<float>(std::sqrt(search.sq_best) + kBoxPadding_m);
  if (!(radius < arguments->query->radius)) return false;
  arguments->query->radius = radius;
  return true;
}

using Polygon = std::vector<Vec3>;  // convex

// Clips a convex polygon at a height and keeps one side [Sutherland1974].
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

// Projects the parts of all triangles between the two heights to height 0.
TriangleMesh flattened(const TriangleMesh& mesh, const ClearanceQuery& query) {
  TriangleMesh flat;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::array<Vec3, 3> corners = mesh.corners(i);
    const Polygon band = clipped(clipped({corners.begin(), corners.end()}, query.low_m, 1.0), query.high_m, -1.0);
    const auto first = static_cast<std::uint32_t>(flat.vertices.size());
    for (const Vec3& corner : band) flat.vertices.emplace_back(corner.x(), corner.y(), 0.0);
    // A triangle that only touches a height gives one or two corners: a triangle without area.
    const auto last = static_cast<std::uint32_t>(flat.vertices.size());
    for (std::uint32_t k = first; k < last && (k == first || k + 2 < last); ++k) {
      flat.triangles.push_back({first, std::min(k + 1, last - 1), std::min(k + 2, last - 1)});
    }
  }
  return flat;
}

}  // namespace

double sq_distance_to_triangle(const Vec3& point_m, const std::array<Vec3, 3>& corners) {
  const auto& [a, b, c] = corners;
  double sq_best = std::min({sq_distance_to_segment(point_m, a, b), sq_distance_to_segment(point_m, b, c),
                             sq_distance_to_segment(point_m, c, a)});
  const Vec3 normal = (b - a).cross(c - a);
  const double sq_normal = normal.dot(normal);
  // The foot of the perpendicular is inside if it is on the inner side of every edge.
  const bool is_above = sq_normal > 0.0 && (b - a).cross(point_m - a).dot(normal) >= 0.0 &&
                        (c - b).cross(point_m - b).dot(normal) >= 0.0 && (a - c).cross(point_m - c).dot(normal) >= 0.0;
  if (is_above) {
    const double height = (point_m - a).dot(normal);
    sq_best = std::min(sq_best, height * height / sq_normal);
  }
  return sq_best;
}

struct SurfaceDistance::Tree : EmbreeBoxes {
  using EmbreeBoxes::EmbreeBoxes;
};

SurfaceDistance::SurfaceDistance(TriangleMesh mesh, const RayCasterOptions& options)
    : tree_(std::make_shared<const Tree>(std::move(mesh), options.embree_isa, nullptr)) {
  if (tree_->mesh().triangles.empty()) throw ConfigError("a scene without any triangle has no surface to measure to");
}

const TriangleMesh& SurfaceDistance::mesh() const { return tree_->mesh(); }

NearestSurface SurfaceDistance::nearest(const Vec3& point_m) const {
  SurfaceSearch search;
  search.mesh = &tree_->mesh();
  search.point_m = point_m;
  if (point_m.cwiseAbs().maxCoeff() <= kMaxCoordinate_m) {
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery query{};
    query.x = static_cast<float>(point_m.x());
    query.y = static_cast<float>(point_m.y());
    query.z = static_cast<float>(point_m.z());
    query.radius = std::numeric_limits<float>::infinity();
    rtcPointQuery(tree_->scene(), &query, &context, propose_triangle, &search);
  } else {
    const auto count = static_cast<std::uint32_t>(search.mesh->triangles.size());
    for (std::uint32_t triangle = 0; triangle < count; ++triangle) search.take(triangle);
  }
  return {std::sqrt(search.sq_best), search.triangle};
}

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

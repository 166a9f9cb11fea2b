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

  /// Whether this triangle is the best so far.
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
  // Triangles at the same distance must still be proposed, so the sphere stays a little larger.
  const auto radius = static_cast<float>(std::sqrt(search.sq_best) + kBoxPadding_m);
  if (!(radius < arguments->query->radius)) return false;
  arguments->query->radius = radius;
  return true;
}

}  // namespace

double sq_distance_to_triangle(const Vec3& point_m, const std::array<Vec3, 3>& corners) {
  const auto& [a, b, c] = corners;
  double sq_best = std::min({sq_distance_to_segment(point_m, a, b), sq_distance_to_segment(point_m, b, c),
                             sq_distance_to_segment(point_m, c, a)});
  const Vec3 normal = (b - a).cross(c - a);
  const double sq_normal = normal.dot(normal);
  // The foot of the perpendicular lies inside when it is on the inner side of every edge.
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

}  // namespace gdtslam::sim

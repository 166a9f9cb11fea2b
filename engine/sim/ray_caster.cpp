#include "gdtslam/sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "embree_boxes.hpp"

namespace gdtslam::sim {
namespace {

// Hits of a ray so far. The context comes first, so that Embree's pointer to it points to the whole struct.
struct Search {
  RTCIntersectContext context;
  const TriangleMesh* mesh = nullptr;
  const ShearedRay* ray = nullptr;
  RayHit best{std::numeric_limits<double>::infinity(), 0};
};
static_assert(std::is_standard_layout_v<Search>);

float padded_far(double range_m) { return static_cast<float>(range_m + kBoxPadding_m); }

void meet_triangle(const RTCIntersectFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) {
    return;
  }
  auto& search = *reinterpret_cast<Search*>(arguments->context);
  const std::uint32_t triangle = arguments->primID;
  const std::optional<double> range_m = search.ray->range_to(search.mesh->corners(triangle));
  if (!range_m || std::pair(*range_m, triangle) >= std::pair(search.best.range_m, search.best.triangle)) {
    return;
  }
  search.best = {*range_m, triangle};
  // The ray ends a little later, so that triangles at the same range are still proposed.
  auto& embree_ray = reinterpret_cast<RTCRayHit*>(arguments->rayhit)->ray;
  embree_ray.tfar = std::min(embree_ray.tfar, padded_far(*range_m));
}

}  // namespace

struct RayCaster::Tree : EmbreeBoxes {
  using EmbreeBoxes::EmbreeBoxes;
};

RayCaster::RayCaster(TriangleMesh mesh, const RayCasterOptions& options)
    : tree_(std::make_shared<const Tree>(std::move(mesh), options.embree_isa, meet_triangle)) {}

const TriangleMesh& RayCaster::mesh() const { return tree_->mesh(); }

std::optional<RayHit> RayCaster::cast(const Ray& ray, double max_range_m) const {
  const ShearedRay sheared(ray);
  Search search;
  rtcInitIntersectContext(&search.context);
  search.mesh = &tree_->mesh();
  search.ray = &sheared;
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(ray.origin_m.x());
  query.ray.org_y = static_cast<float>(ray.origin_m.y());
  query.ray.org_z = static_cast<float>(ray.origin_m.z());
  query.ray.dir_x = static_cast<float>(ray.direction.x());
  query.ray.dir_y = static_cast<float>(ray.direction.y());
  query.ray.dir_z = static_cast<float>(ray.direction.z());
  query.ray.tfar = padded_far(std::min(max_range_m, kMaxReach_m));
  query.ray.mask = ~0U;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(tree_->scene(), &search.context, &query);
  return search.best.range_m <= max_range_m ? std::optional<RayHit>(search.best) : std::nullopt;
}

}  // namespace gdtslam::sim

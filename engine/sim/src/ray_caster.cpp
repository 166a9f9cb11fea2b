#include "gdtslam/sim/ray_caster.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

// Embree works in single precision. Within kMaxCoordinate_m of the origin and ranges up to twice that, the ray's origin
// is off by at most 6e-5 m, its far end by 2e-4 m; a box padded by this is entered whenever the triangle in it is met.
constexpr double kPadding_m = 2e-3;
constexpr double kMaxRange_m = 3.0 * kMaxCoordinate_m;

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceRelease>;
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneRelease>;

// What a ray has met so far. The context comes first, so that Embree's pointer to it is one to the whole.
struct Search {
  RTCIntersectContext context;
  const TriangleMesh* mesh = nullptr;
  const ShearedRay* ray = nullptr;
  RayHit best{std::numeric_limits<double>::infinity(), 0};
};
static_assert(std::is_standard_layout_v<Search>);

float padded_far(double range_m) { return static_cast<float>(range_m + kPadding_m); }

void bounds_of_triangle(const RTCBoundsFunctionArguments* arguments) {
  const auto& mesh = *static_cast<const TriangleMesh*>(arguments->geometryUserPtr);
  const std::array<Vec3, 3> corners = mesh.corners(arguments->primID);
  const Vec3 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
  const Vec3 high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
  RTCBounds& bounds = *arguments->bounds_o;
  bounds.lower_x = static_cast<float>(low.x() - kPadding_m);
  bounds.lower_y = static_cast<float>(low.y() - kPadding_m);
  bounds.lower_z = static_cast<float>(low.z() - kPadding_m);
  bounds.upper_x = static_cast<float>(high.x() + kPadding_m);
  bounds.upper_y = static_cast<float>(high.y() + kPadding_m);
  bounds.upper_z = static_cast<float>(high.z() + kPadding_m);
}

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
  // Triangles at the same range must still be proposed, so the ray ends a little later.
  auto& embree_ray = reinterpret_cast<RTCRayHit*>(arguments->rayhit)->ray;
  embree_ray.tfar = std::min(embree_ray.tfar, padded_far(*range_m));
}

// Embree wants a function; a null one would make it count occlusion queries, which are never sent, as misses.
void occlude_nothing(const RTCOccludedFunctionNArguments* /*arguments*/) {}

// Embree takes any name without a word, and would run instructions that the processor lacks.
bool can_run(const std::string& isa) {
#if defined(__x86_64__) || defined(__i386__)
  return isa.empty() || isa == "sse2" || (isa == "sse4.2" && __builtin_cpu_supports("sse4.2") != 0) ||
         (isa == "avx" && __builtin_cpu_supports("avx") != 0) ||
         (isa == "avx2" && __builtin_cpu_supports("avx2") != 0) ||
         (isa == "avx512" && __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0);
#else
  return isa.empty();
#endif
}

std::string device_settings(const RayCasterOptions& options) {
  if (!can_run(options.embree_isa)) {
    throw UnavailableError("Embree cannot run with the instruction set '" + options.embree_isa +
                           "' here: use sse2, sse4.2, avx, avx2 or avx512 as far as the processor has them");
  }
  // One thread: building is the only thing Embree would share out, and it starts no threads of its own this way.
  return "threads=1" + (options.embree_isa.empty() ? std::string() : ",isa=" + options.embree_isa);
}

void check_mesh(const TriangleMesh& mesh) {
  if (mesh.triangles.size() > kMaxTriangles) {
    throw ConfigError("the scene has more than " + std::to_string(kMaxTriangles) + " triangles");
  }
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      if (vertex >= mesh.vertices.size() || !mesh.vertices[vertex].allFinite() ||
          mesh.vertices[vertex].cwiseAbs().maxCoeff() > 1.01 * kMaxCoordinate_m) {
        throw ConfigError("a triangle of the scene names a vertex that is missing or further out than 1000 m");
      }
    }
  }
}

}  // namespace

struct RayCaster::Tree {
  TriangleMesh mesh;
  Device device;
  SceneHandle scene;

  void require_success(const char* what) const {
    if (const RTCError error = rtcGetDeviceError(device.get()); error != RTC_ERROR_NONE) {
      throw UnavailableError(std::string("Embree failed to ") + what + " (error " + std::to_string(error) + ")");
    }
  }
};

RayCaster::RayCaster(TriangleMesh mesh, const RayCasterOptions& options) : tree_(std::make_unique<Tree>()) {
  check_mesh(mesh);
  Tree& tree = *tree_;
  tree.mesh = std::move(mesh);
  tree.device.reset(rtcNewDevice(device_settings(options).c_str()));
  if (!tree.device) {
    throw UnavailableError("Embree cannot start on this processor (error " +
                           std::to_string(rtcGetDeviceError(nullptr)) + ")");
  }
  tree.scene.reset(rtcNewScene(tree.device.get()));
  rtcSetSceneFlags(tree.scene.get(), RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(tree.device.get(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned int>(tree.mesh.triangles.size()));
  rtcSetGeometryUserData(geometry, &tree.mesh);
  rtcSetGeometryBoundsFunction(geometry, bounds_of_triangle, nullptr);
  rtcSetGeometryIntersectFunction(geometry, meet_triangle);
  rtcSetGeometryOccludedFunction(geometry, occlude_nothing);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(tree.scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(tree.scene.get());
  tree.require_success("build its tree");
}

RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

const TriangleMesh& RayCaster::mesh() const { return tree_->mesh; }

std::optional<RayHit> RayCaster::cast(const Ray& ray, double max_range_m) const {
  const ShearedRay sheared(ray);
  Search search;
  rtcInitIntersectContext(&search.context);
  search.mesh = &tree_->mesh;
  search.ray = &sheared;
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(ray.origin_m.x());
  query.ray.org_y = static_cast<float>(ray.origin_m.y());
  query.ray.org_z = static_cast<float>(ray.origin_m.z());
  query.ray.dir_x = static_cast<float>(ray.direction.x());
  query.ray.dir_y = static_cast<float>(ray.direction.y());
  query.ray.dir_z = static_cast<float>(ray.direction.z());
  query.ray.tfar = padded_far(std::min(max_range_m, kMaxRange_m));
  query.ray.mask = ~0U;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(tree_->scene.get(), &search.context, &query);
  return search.best.range_m <= max_range_m ? std::optional<RayHit>(search.best) : std::nullopt;
}

}  // namespace gdtslam::sim

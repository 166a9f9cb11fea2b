#include "embree_boxes.hpp"

#include <array>
#include <cstdint>
#include <new>
#include <string>
#include <utility>

#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

void bounds_of_triangle(const RTCBoundsFunctionArguments* arguments) {
  const auto& mesh = *static_cast<const TriangleMesh*>(arguments->geometryUserPtr);
  const std::array<Vec3, 3> corners = mesh.corners(arguments->primID);
  const Vec3 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
  const Vec3 high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
  RTCBounds& bounds = *arguments->bounds_o;
  bounds.lower_x = static_cast<float>(low.x() - kBoxPadding_m);
  bounds.lower_y = static_cast<float>(low.y() - kBoxPadding_m);
  bounds.lower_z = static_cast<float>(low.z() - kBoxPadding_m);
  bounds.upper_x = static_cast<float>(high.x() + kBoxPadding_m);
  bounds.upper_y = static_cast<float>(high.y() + kBoxPadding_m);
  bounds.upper_z = static_cast<float>(high.z() + kBoxPadding_m);
}

// With a null function Embree would count occlusion queries, which are never sent, as misses.
void occlude_nothing(const RTCOccludedFunctionNArguments* /*arguments*/) {}

// Embree accepts any name silently, and would run instructions that the processor lacks.
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

std::string device_settings(const std::string& isa) {
  if (!can_run(isa)) {
    throw UnavailableError("Embree cannot run with the instruction set '" + isa +
                           "' here: use sse2, sse4.2, avx, avx2 or avx512 as far as the processor has them");
  }
  // One thread: only building could run in parallel, and this way Embree starts no threads.
  return "threads=1" + (isa.empty() ? std::string() : ",isa=" + isa);
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

[[noreturn]] void throw_error(const std::string& what, RTCError error) {
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw UnavailableError(what + " (error " + std::to_string(error) + ")");
}

}  // namespace

EmbreeBoxes::EmbreeBoxes(TriangleMesh mesh, const std::string& isa, RTCIntersectFunctionN intersect)
    : mesh_(std::move(mesh)) {
  check_mesh(mesh_);
  device_.reset(rtcNewDevice(device_settings(isa).c_str()));
  if (!device_) throw_error("Embree cannot start on this processor", rtcGetDeviceError(nullptr));
  scene_.reset(rtcNewScene(device_.get()));
  if (!scene_) throw_error("Embree failed to begin a scene", rtcGetDeviceError(device_.get()));
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned int>(mesh_.triangles.size()));
  rtcSetGeometryUserData(geometry, &mesh_);
  rtcSetGeometryBoundsFunction(geometry, bounds_of_triangle, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcSetGeometryOccludedFunction(geometry, occlude_nothing);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_.get());
  if (const RTCError error = rtcGetDeviceError(device_.get()); error != RTC_ERROR_NONE) {
    static_cast<void>(scene_.release());  // Embree ends the program if it frees a tree that it could not build
    throw_error("Embree failed to build its tree", error);
  }
}

}  // namespace gdtslam::sim

// The first triangle that a ray meets. Embree's tree proposes triangles; this code computes ranges in double precision
// and chooses: the smallest range, then the lowest triangle index. Embree's own hits differ between its instruction
// sets (by up to 4e-6 m, and near an edge by the triangle), so Embree only tests boxes, padded by more than its
// rounding. The result equals a search through all triangles, bit for bit, on every host. Metres, map frame. Building:
// O(n log n); a cast: O(log n), about a microsecond. cast() is thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {

/// A half-line; the direction has length 1.
struct Ray {
  Vec3 origin_m{0.0, 0.0, 0.0};
  Vec3 direction{1.0, 0.0, 0.0};
};

/// A ray prepared for intersection with triangles, by its main axis and the shear that maps the ray to that axis.
/// Double precision and watertight: a ray through the common edge of two triangles meets at least one of them
/// [Woop2013]. No fused multiply-add, so the range has the same bits on every host.
class ShearedRay {
 public:
  explicit ShearedRay(const Ray& ray);
  /// Distance from the origin to the triangle, from either side. Empty if the ray misses it or is in its plane, or if
  /// the triangle has no area. Edges belong to the triangle.
  [[nodiscard]] std::optional<double> range_to(const std::array<Vec3, 3>& corners) const;

 private:
  Vec3 origin_m_;
  int axis_x_ = 0;
  int axis_y_ = 1;
  int axis_z_ = 2;  ///< the axis along which the direction is longest
  double shear_x_ = 0.0;
  double shear_y_ = 0.0;
  double scale_z_ = 1.0;
};

/// The first hit of a ray.
struct RayHit {
  double range_m = 0.0;
  std::uint32_t triangle = 0;
  friend bool operator==(const RayHit&, const RayHit&) = default;
};

/// Options of Embree.
struct RayCasterOptions {
  std::string embree_isa;  ///< sse2, sse4.2, avx, avx2 or avx512 forces one; empty lets Embree choose
};

/// Casts rays at one mesh.
class RayCaster {
 public:
  /// Throws UnavailableError if Embree cannot start, ConfigError for a mesh that triangulate() would reject.
  explicit RayCaster(TriangleMesh mesh, const RayCasterOptions& options = {});

  /// Empty if the ray meets no triangle within max_range_m (inclusive).
  [[nodiscard]] std::optional<RayHit> cast(const Ray& ray, double max_range_m) const;
  [[nodiscard]] const TriangleMesh& mesh() const;

 private:
  struct Tree;
  std::shared_ptr<const Tree> tree_;
};

}  // namespace gdtslam::sim

// The first triangle that a ray meets. Embree's tree proposes triangles; range and choice are ours, in double
// precision: the smallest range wins, the lowest triangle index among equals. Embree's own hits differ between its
// instruction sets (by up to 4e-6 m, and near an edge by the triangle), so it only ever sees boxes, padded by more than
// its rounding: the result is that of a search through all triangles, bit for bit, on every host. Metres, map frame.
// Building: O(n log n); a cast: O(log n), about a microsecond. cast() is thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "gdtslam/sim/ray_triangle.hpp"
#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {

/// The first hit of a ray.
struct RayHit {
  double range_m = 0.0;
  std::uint32_t triangle = 0;
  friend bool operator==(const RayHit&, const RayHit&) = default;
};

/// How Embree is used.
struct RayCasterOptions {
  std::string embree_isa;  ///< sse2, sse4.2, avx, avx2 or avx512 forces one; empty lets Embree choose
};

/// Casts rays at one mesh.
class RayCaster {
 public:
  /// Throws UnavailableError when Embree cannot start, ConfigError for a mesh that triangulate() would not have made.
  explicit RayCaster(TriangleMesh mesh, const RayCasterOptions& options = {});

  /// Empty if the ray meets no triangle within max_range_m (inclusive).
  [[nodiscard]] std::optional<RayHit> cast(const Ray& ray, double max_range_m) const;
  [[nodiscard]] const TriangleMesh& mesh() const;

 private:
  struct Tree;
  std::shared_ptr<const Tree> tree_;
};

}  // namespace gdtslam::sim

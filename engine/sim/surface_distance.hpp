// Distance of a point to the nearest surface of a scene, for judging measured clouds. As in ray_caster.hpp, Embree's
// tree proposes triangles; this code computes distances in double precision and chooses: the smallest distance, then
// the lowest triangle index. So the result equals a search through all triangles, bit for bit, on every host. Metres,
// the scene's frame. Building: O(n log n); a query: O(log n), some microseconds; O(n) for points beyond single
// precision. Thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "gdtslam/sim/ray_caster.hpp"
#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {

/// Squared distance of a point to a triangle (inside, edges, corners); without area only its edges count.
double sq_distance_to_triangle(const Vec3& point_m, const std::array<Vec3, 3>& corners);

struct NearestSurface {
  double distance_m = 0.0;
  std::uint32_t triangle = 0;
  friend bool operator==(const NearestSurface&, const NearestSurface&) = default;
};

class SurfaceDistance {
 public:
  /// Throws UnavailableError if Embree cannot start, ConfigError for a mesh without triangles or one that triangulate()
  /// would reject.
  explicit SurfaceDistance(TriangleMesh mesh, const RayCasterOptions& options = {});

  /// The coordinates of the point must be finite and within 1e150 m.
  [[nodiscard]] NearestSurface nearest(const Vec3& point_m) const;
  [[nodiscard]] const TriangleMesh& mesh() const;

 private:
  struct Tree;
  std::shared_ptr<const Tree> tree_;
};

/// Obstacles to consider, and the search limit.
struct ClearanceQuery {
  double low_m = 0.0;  ///< only obstacles between these two heights count
  double high_m = 1.0;
  double limit_m = 1.0;  ///< result if nothing is nearer; above 0
};

/// Horizontal distance of each position to the nearest obstacle, in the order of the positions; 0 inside one. All parts
/// of a scene between the two heights are obstacles. Memory is linear in triangles and positions; each position takes
/// some microseconds.
std::vector<double> clearances_m(const TriangleMesh& mesh, const ClearanceQuery& query,
                                 const std::vector<Point2>& places_m);

}  // namespace gdtslam::sim

// How far a point in space is from the nearest surface of a scene: what a measured cloud is judged by. Embree's tree
// proposes triangles; distance and choice are ours, in double precision, as in ray_caster.hpp: the smallest distance
// wins, the lowest triangle index among equals, so the result is that of a search through all triangles, bit for bit,
// on every host. Metres, the scene's frame. Building: O(n log n); a query: O(log n), some microseconds; O(n) for a
// point so far out that single precision cannot find its way back. Thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "gdtslam/sim/ray_caster.hpp"
#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {

/// Squared distance of a point to a triangle with its inside, edges and corners; one without area is its edges.
double sq_distance_to_triangle(const Vec3& point_m, const std::array<Vec3, 3>& corners);

struct NearestSurface {
  double distance_m = 0.0;
  std::uint32_t triangle = 0;
  friend bool operator==(const NearestSurface&, const NearestSurface&) = default;
};

class SurfaceDistance {
 public:
  /// Throws UnavailableError when Embree cannot start, ConfigError for a mesh that triangulate() would not have made,
  /// one without triangles included.
  explicit SurfaceDistance(TriangleMesh mesh, const RayCasterOptions& options = {});

  /// The coordinates of the point are finite and within 1e150 m.
  [[nodiscard]] NearestSurface nearest(const Vec3& point_m) const;
  [[nodiscard]] const TriangleMesh& mesh() const;

 private:
  struct Tree;
  std::shared_ptr<const Tree> tree_;
};

/// Which obstacles count, and how far to look.
struct ClearanceQuery {
  double low_m = 0.0;  ///< only what lies between these two heights counts
  double high_m = 1.0;
  double limit_m = 1.0;  ///< the answer where nothing is nearer; above 0
};

/// The distance of each place to the nearest obstacle, seen from above: every part of a scene between the two heights
/// counts. In the order of the places; 0 within one. Memory is linear in triangles and places; a place takes some
/// microseconds.
std::vector<double> clearances_m(const TriangleMesh& mesh, const ClearanceQuery& query,
                                 const std::vector<Point2>& places_m);

}  // namespace gdtslam::sim

// Embree's tree over boxes around the triangles of a mesh, for queries that decide by double arithmetic of their own.
// Boxes are padded by more than the rounding of Embree's single precision, so a query that asks for what lies within
// its reach plus kBoxPadding_m is told of every triangle that matters, whatever instruction set Embree runs.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <string>
#include <type_traits>

#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {

// Within kMaxCoordinate_m of the origin and ranges up to twice that, a coordinate is off by at most 6e-5 m, the far end
// of a ray by 2e-4 m.
inline constexpr double kBoxPadding_m = 2e-3;
/// The farthest that a query may reach.
inline constexpr double kMaxReach_m = 3.0 * kMaxCoordinate_m;

struct EmbreeRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

/// Stays where it is: Embree holds a pointer to the mesh.
class EmbreeBoxes {
 public:
  /// `intersect` may be null where no ray is cast. Throws UnavailableError when Embree cannot start or lacks the
  /// instruction set, ConfigError for a mesh that triangulate() would not have made.
  EmbreeBoxes(TriangleMesh mesh, const std::string& isa, RTCIntersectFunctionN intersect);
  EmbreeBoxes(const EmbreeBoxes&) = delete;
  EmbreeBoxes& operator=(const EmbreeBoxes&) = delete;
  ~EmbreeBoxes() = default;

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] RTCScene scene() const { return scene_.get(); }

 private:
  TriangleMesh mesh_;
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, EmbreeRelease> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, EmbreeRelease> scene_;
};

}  // namespace gdtslam::sim

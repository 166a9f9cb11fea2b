// Embree's tree over boxes around the triangles of a mesh, for queries that compute in double precision themselves.
// Boxes are padded by more than the rounding of Embree's single precision. So a query within its reach plus
// kBoxPadding_m receives every relevant triangle, whatever instruction set Embree uses.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <string>
#include <type_traits>

#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {

// Within kMaxCoordinate_m of the origin and ranges up to twice that, the error of a coordinate is at most 6e-5 m, that
// of a ray's far end 2e-4 m.
inline constexpr double kBoxPadding_m = 2e-3;
/// Longest reach of a query.
inline constexpr double kMaxReach_m = 3.0 * kMaxCoordinate_m;

struct EmbreeRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

/// Not movable: Embree holds a pointer to the mesh.
class EmbreeBoxes {
 public:
  /// `intersect` may be null if no ray is cast. Throws UnavailableError if Embree cannot start or lacks the instruction
  /// set, ConfigError for a mesh that triangulate() would reject.
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

// Intersection of a ray and a triangle, in double precision, watertight: a ray through the common edge of two triangles
// meets at least one of them [Woop2013]. No fused multiply-add, so the range has the same bits on every host. Metres,
// any frame. Thread-safe, constant time.
#pragma once

#include <array>
#include <optional>

#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {

/// A half-line; the direction has length 1.
struct Ray {
  Vec3 origin_m{0.0, 0.0, 0.0};
  Vec3 direction{1.0, 0.0, 0.0};
};

/// A ray with what is the same for all triangles: its main axis and the shear that turns the ray into that axis.
class ShearedRay {
 public:
  explicit ShearedRay(const Ray& ray);
  /// Distance from the origin to the triangle, from either side; nothing when the ray misses it, lies in its plane, or
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

}  // namespace gdtslam::sim

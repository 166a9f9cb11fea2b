#include "gdtslam/sim/ray_caster.hpp"

#include <cmath>

namespace gdtslam::sim {

ShearedRay::ShearedRay(const Ray& ray) : origin_m_(ray.origin_m) {
  ray.direction.cwiseAbs().maxCoeff(&axis_z_);
  axis_x_ = (axis_z_ + 1) % 3;
  axis_y_ = (axis_z_ + 2) % 3;
  shear_x_ = ray.direction[axis_x_] / ray.direction[axis_z_];
  shear_y_ = ray.direction[axis_y_] / ray.direction[axis_z_];
  scale_z_ = 1.0 / ray.direction[axis_z_];
}

std::optional<double> ShearedRay::range_to(const std::array<Vec3, 3>& corners) const {
  std::array<double, 3> x{};
  std::array<double, 3> y{};
  std::array<double, 3> z{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 p = corners[i] - origin_m_;
    x[i] = p[axis_x_] - shear_x_ * p[axis_z_];
    y[i] = p[axis_y_] - shear_y_ * p[axis_z_];
    z[i] = scale_z_ * p[axis_z_];
  }
  // Reversing an edge changes only the sign of its function, so that neighbours agree.
  const double u = x[2] * y[1] - y[2] * x[1];
  const double v = x[0] * y[2] - y[0] * x[2];
  const double w = x[1] * y[0] - y[1] * x[0];
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) {
    return std::nullopt;
  }
  const double determinant = u + v + w;
  if (determinant == 0.0) {
    return std::nullopt;
  }
  const double range_m = (u * z[0] + v * z[1] + w * z[2]) / determinant;
  return range_m > 0.0 ? std::optional<double>(range_m) : std::nullopt;
}

}  // namespace gdtslam::sim

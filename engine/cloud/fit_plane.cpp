#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/error.hpp"
#include "to_position.hpp"

namespace gdtslam {
namespace {

Point3 centroid(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points) {
  Point3 sum = Point3::Zero();
  for (const std::uint32_t k : points) sum += to_position(cloud[k]);
  return sum / static_cast<double>(points.size());
}

// Second moments about the centre, divided by the number of points.
Eigen::Matrix3d scatter_matrix(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points,
                               const Point3& centre) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const std::uint32_t k : points) {
    const Point3 d = to_position(cloud[k]) - centre;
    sum += d * d.transpose();
  }
  return sum / static_cast<double>(points.size());
}

// Points on one line leave no more scatter across it than the rounding of their coordinates.
bool is_line(const Eigen::Vector3d& extents, const Point3& centre) {
  constexpr double kFloatStep = 1.2e-7;
  const double grain_m = kFloatStep * (centre.norm() + std::sqrt(extents[2]));
  return !(extents[1] > grain_m * grain_m);
}

}  // namespace

// The direction of least scatter; its error follows from the noise about the plane and the extent within it.
std::optional<PlanePatch> fitted_plane(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points) {
  if (points.size() < 3) return std::nullopt;
  PlanePatch patch;
  patch.centre = centroid(cloud, points);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter_matrix(cloud, points, patch.centre));
  const Eigen::Vector3d extents = solver.eigenvalues().cwiseMax(0.0);  // ascending
  if (is_line(extents, patch.centre)) return std::nullopt;
  patch.points.assign(points.begin(), points.end());
  patch.plane.normal = solver.eigenvectors().col(0).normalized();
  patch.plane.offset_m = patch.plane.normal.dot(patch.centre);
  const auto count = static_cast<double>(points.size());
  patch.rms_m = std::sqrt(extents[0]);
  const double sigma_m = std::sqrt(extents[0] * count / std::max(1.0, count - 3.0));
  patch.sigma_centre_m = sigma_m / std::sqrt(count);
  Eigen::Vector3d parts_m(patch.sigma_centre_m, 0.0, 0.0);
  for (const int axis : {1, 2}) {  // towards which the normal turns, with the centre's way from the foot for a lever
    parts_m[axis] = solver.eigenvectors().col(axis).dot(patch.centre) * sigma_m / std::sqrt(count * extents[axis]);
  }
  patch.sigma_offset_m = parts_m.norm();
  patch.sigma_normal_rad = sigma_m / std::sqrt(count * extents[1]);
  return patch;
}

PlanePatch fit_plane(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points) {
  std::optional<PlanePatch> patch = fitted_plane(cloud, points);
  if (!patch) throw InputError("a plane needs at least three points that are not on one line");
  return *std::move(patch);
}

}  // namespace gdtslam

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/error.hpp"
#include "position_of.hpp"

namespace gdtslam {
namespace {

Point3 centre_of(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points) {
  Point3 sum = Point3::Zero();
  for (const std::uint32_t k : points) sum += position_of(cloud[k]);
  return sum / static_cast<double>(points.size());
}

// Second moments about the centre, divided by the number of points.
Eigen::Matrix3d scatter_of(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points,
                           const Point3& centre) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const std::uint32_t k : points) {
    const Point3 d = position_of(cloud[k]) - centre;
    sum += d * d.transpose();
  }
  return sum / static_cast<double>(points.size());
}

}  // namespace

// The direction of least scatter; its error follows from the noise about the plane and the extent within it.
PlanePatch fit_plane(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points) {
  if (points.size() < 3) throw InputError("a plane needs at least three points");
  PlanePatch patch;
  patch.points.assign(points.begin(), points.end());
  patch.centre = centre_of(cloud, points);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter_of(cloud, points, patch.centre));
  const Eigen::Vector3d extents = solver.eigenvalues().cwiseMax(0.0);  // ascending
  if (!(extents[1] > 0.0)) throw InputError("the points of a plane lie on one line");
  patch.plane.normal = solver.eigenvectors().col(0).normalized();
  patch.plane.offset_m = patch.plane.normal.dot(patch.centre);
  const auto count = static_cast<double>(points.size());
  patch.rms_m = std::sqrt(extents[0]);
  const double sigma_m = std::sqrt(extents[0] * count / std::max(1.0, count - 3.0));
  patch.sigma_offset_m = sigma_m / std::sqrt(count);
  patch.sigma_normal_rad = sigma_m / std::sqrt(count * extents[1]);
  return patch;
}

}  // namespace gdtslam

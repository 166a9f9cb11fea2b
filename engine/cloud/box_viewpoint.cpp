#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "gdtslam/cloud/plane.hpp"
#include "to_position.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostPoints = 200'000;
constexpr double kMostPlaneRms_m = 0.03;  // RMS of the points from the planes of their elevations
constexpr double kMostStretch = 0.03;     // deviation of the heading's length from 1
constexpr double kSteepest_rad = 1.4;     // beyond, the tangent says more about the elevation's error than the place
constexpr double kLeastSpread = 0.02;     // standard deviation of the elevations' tangents
constexpr double kLeastBoxPoints = 100;

struct Fit {
  Eigen::Vector4d answer = Eigen::Vector4d::Zero();
  double rms_m = 0.0;
  double spread = 0.0;  ///< standard deviation of the tangents
};

// z = height + tan(elevation) (x cos(heading) + y sin(heading) - forward), linear in height, the heading's two
// components and the place along it.
std::optional<Fit> fit(std::span<const CloudPoint> cloud) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double count = 0.0;
  double squares = 0.0;
  double tangents = 0.0;
  double sq_tangents = 0.0;
  const std::size_t every = std::max<std::size_t>(1, cloud.size() / kMostPoints);
  for (std::size_t k = 0; k < cloud.size(); k += every) {
    const Point3 point = to_position(cloud[k]);
    const auto elevation_rad = static_cast<double>(cloud[k].elevation_rad);
    if (!point.allFinite() || !(std::fabs(elevation_rad) <= kSteepest_rad)) continue;
    const SinCos<double> elevation = sin_cos(elevation_rad);
    const double tangent = elevation.sin / elevation.cos;
    // Weighted by the cosine, which is how far the plane is from a point for an error of its height.
    const Eigen::Vector4d row =
        elevation.cos * Eigen::Vector4d(1.0, tangent * point.x(), tangent * point.y(), -tangent);
    normal += row * row.transpose();
    right += row * (elevation.cos * point.z());
    squares += elevation.cos * point.z() * elevation.cos * point.z();
    tangents += tangent;
    sq_tangents += tangent * tangent;
    count += 1.0;
  }
  if (count < kLeastBoxPoints) return std::nullopt;
  Fit result;
  result.answer = normal.ldlt().solve(right);
  result.rms_m = std::sqrt(std::fabs(squares - result.answer.dot(right)) / count);
  result.spread = std::sqrt(std::fabs(sq_tangents / count - tangents * tangents / (count * count)));
  return result;
}

}  // namespace

std::optional<Point3> standing_viewpoint(std::span<const CloudPoint> cloud) {
  const std::optional<Fit> found = fit(cloud);
  if (!found || !found->answer.allFinite() || found->spread < kLeastSpread || found->rms_m > kMostPlaneRms_m) {
    return std::nullopt;
  }
  const double length = std::sqrt(found->answer[1] * found->answer[1] + found->answer[2] * found->answer[2]);
  if (std::fabs(length - 1.0) > kMostStretch) return std::nullopt;
  const double forward_m = found->answer[3] / length;
  return Point3(forward_m * found->answer[1] / length, forward_m * found->answer[2] / length, found->answer[0]);
}

}  // namespace gdtslam

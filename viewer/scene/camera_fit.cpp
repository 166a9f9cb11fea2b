// Cameras that show a whole box. For a given direction the nearest camera is exact: in the camera's axes a point
// (u, v, w) is in the picture while |u - a| <= (w + d) t, and the least distance d of the camera follows from the
// extremes of u - w t and u + w t over the points; likewise for v. Its shift a is what is left to choose.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "camera_basis.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/viewer/camera.hpp"

namespace gdtslam {
namespace {

constexpr double kOrbitMarginShare = 0.02;  // corners come there but in passing
constexpr double kMarginShare = 0.06;       // of the picture, on each side
constexpr double kIsoSlopeRad = 0.663;      // 38 degrees
constexpr double kIsoTurnRad = 0.4887;      // 28 degrees between the line of sight and the normal of the longer side
constexpr double kIsoViewAngleRad = 0.42;
constexpr double kLeastSide_m = 0.2;

Bounds shown(const Bounds& bounds) {
  if (bounds.is_empty()) return {.lowest = Point3::Constant(-0.5), .highest = Point3::Constant(0.5)};
  Bounds box = bounds;
  if ((box.highest - box.lowest).maxCoeff() < kLeastSide_m) {
    box.lowest.array() -= 0.5 * kLeastSide_m;
    box.highest.array() += 0.5 * kLeastSide_m;
  }
  return box;
}

std::vector<Point3> corners_of(const Bounds& box) {
  std::vector<Point3> corners;
  for (const double x : {box.lowest.x(), box.highest.x()}) {
    for (const double y : {box.lowest.y(), box.highest.y()}) {
      for (const double z : {box.lowest.z(), box.highest.z()}) corners.emplace_back(x, y, z);
    }
  }
  return corners;
}

// The distance that one direction of the picture asks for, wherever along it the camera is.
double least_distance_m(const Point3& axis, const Point3& forward, double slope, const Point3& centre,
                        const std::vector<Point3>& points) {
  double low = -1e300;
  double high = 1e300;
  for (const Point3& point : points) {
    const double u = axis.dot(point - centre);
    const double w = forward.dot(point - centre);
    low = std::max(low, u - w * slope);
    high = std::min(high, u + w * slope);
  }
  return 0.5 * (low - high) / slope;
}

// The shift at which the points are as far from one edge of the picture as from the other, at this distance; exact for
// the direction that asks for the distance, in which nothing is left to choose.
double centring_shift_m(const Point3& axis, const Point3& forward, double distance_m, const Point3& centre,
                        const std::vector<Point3>& points) {
  const auto lean = [&](double shift_m) {
    double low = 1e300;
    double high = -1e300;
    for (const Point3& point : points) {
      const double at = (axis.dot(point - centre) - shift_m) / (forward.dot(point - centre) + distance_m);
      low = std::min(low, at);
      high = std::max(high, at);
    }
    return low + high;  // falls with the shift
  };
  double below = 1e300;
  double above = -1e300;
  for (const Point3& point : points) {
    below = std::min(below, axis.dot(point - centre));
    above = std::max(above, axis.dot(point - centre));
  }
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (below + above);
    (lean(middle) > 0.0 ? below : above) = middle;
  }
  return 0.5 * (below + above);
}

// Line of sight of the iso camera; the eye is that much west of south.
Point3 iso_sight(double west_of_south_rad) {
  const SinCos<double> slope = sin_cos(kIsoSlopeRad);
  const SinCos<double> heading = sin_cos(west_of_south_rad);
  return {slope.cos * heading.sin, slope.cos * heading.cos, -slope.sin};
}

Camera iso_camera(const Bounds& box, const PictureSize& size) {
  const std::vector<Point3> corners = corners_of(box);
  const auto from = [&](double west_of_south_rad) {
    return nearest_camera(iso_sight(west_of_south_rad), kIsoViewAngleRad, box.centre(), corners, size, kMarginShare);
  };
  const Camera southern = from(kIsoTurnRad);
  const Camera western = from(0.5 * kPi - kIsoTurnRad);
  const bool is_nearer = (western.eye - western.target).norm() < (southern.eye - southern.target).norm();
  return is_nearer ? western : southern;
}

Camera parallel_camera(const Point3& forward, const Point3& up, const Bounds& box, const PictureSize& size) {
  Camera camera;
  camera.is_parallel = true;
  camera.target = box.centre();
  camera.up = up;
  camera.eye = camera.target - forward * ((box.highest - box.lowest).norm() + 1.0);
  const CameraBasis basis = basis_of(camera);
  const Point3 sides = box.highest - box.lowest;
  const double across_m = basis.right.cwiseAbs().dot(sides);
  const double upwards_m = basis.up.cwiseAbs().dot(sides);
  camera.parallel_height_m = std::max({upwards_m, across_m / size.aspect(), kLeastSide_m}) / (1.0 - 2.0 * kMarginShare);
  return camera;
}

Camera top_camera(const Bounds& box, const PictureSize& size) {
  const Camera y_up = parallel_camera(-Point3::UnitZ(), Point3::UnitY(), box, size);
  const Camera x_up = parallel_camera(-Point3::UnitZ(), Point3::UnitX(), box, size);
  return x_up.parallel_height_m < y_up.parallel_height_m ? x_up : y_up;
}

}  // namespace

Camera nearest_camera(const Point3& forward, double view_angle_rad, const Point3& centre,
                      const std::vector<Point3>& points, const PictureSize& size, double margin_share) {
  Camera camera;
  camera.view_angle_rad = view_angle_rad;
  camera.target = centre;
  camera.eye = centre - forward;
  const CameraBasis basis = basis_of(camera);
  const double slope = half_height_slope(camera) * (1.0 - 2.0 * margin_share);
  const double distance_m =
      std::max(least_distance_m(basis.right, basis.forward, slope * size.aspect(), centre, points),
               least_distance_m(basis.up, basis.forward, slope, centre, points));
  camera.target = centre + centring_shift_m(basis.right, basis.forward, distance_m, centre, points) * basis.right +
                  centring_shift_m(basis.up, basis.forward, distance_m, centre, points) * basis.up;
  camera.eye = camera.target - distance_m * basis.forward;
  return camera;
}

Camera fitting_camera(CameraPreset preset, const Bounds& bounds, const PictureSize& size) {
  const Bounds box = shown(bounds);
  switch (preset) {
    case CameraPreset::kTop:
      return top_camera(box, size);
    case CameraPreset::kFront:
      return parallel_camera(Point3::UnitY(), Point3::UnitZ(), box, size);
    case CameraPreset::kSide:
      return parallel_camera(-Point3::UnitX(), Point3::UnitZ(), box, size);
    case CameraPreset::kIso:
    case CameraPreset::kFollow:
      break;
  }
  assert(preset == CameraPreset::kIso);  // a follow camera needs a robot
  return iso_camera(box, size);
}

Camera orbit_camera(const Bounds& bounds, const PictureSize& size) {
  constexpr int kDirections = 64;  // of the cylinder that the turning box sweeps; at most 0.12 % of its radius off
  const Bounds box = shown(bounds);
  const Point3 half = 0.5 * (box.highest - box.lowest);
  const double radius_m = std::sqrt(half.x() * half.x() + half.y() * half.y());
  const Point3 sight = iso_sight(kIsoTurnRad);
  std::vector<Point3> rims;
  for (int k = 0; k < kDirections; ++k) {
    const SinCos<double> direction = sin_cos(kTwoPi * k / kDirections - kIsoTurnRad);  // alike on both sides
    for (const double z : {box.lowest.z(), box.highest.z()}) {
      rims.emplace_back(box.centre().x() + radius_m * direction.cos, box.centre().y() + radius_m * direction.sin, z);
    }
  }
  Camera camera = nearest_camera(sight, kIsoViewAngleRad, box.centre(), rims, size, kOrbitMarginShare);
  // The target moves along the line of sight to the box's axis, about which the camera turns.
  const CameraBasis basis = basis_of(camera);
  const Point3 level(basis.forward.x(), basis.forward.y(), 0.0);
  camera.target += basis.forward * (level.dot(box.centre() - camera.target) / level.dot(level));
  return camera;
}

}  // namespace gdtslam

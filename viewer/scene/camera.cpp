#include "gdtslam/viewer/camera.hpp"

#include <cmath>

#include "camera_basis.hpp"
#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

constexpr double kFollowHeight_m = 1.9;    // below ceilings, above furniture
constexpr double kFollowLookedAt_m = 0.6;  // above the floor: more is to be seen before the robot than behind it
constexpr double kFollowAhead_m = 0.8;
constexpr double kFollowViewAngleRad = 0.95;

}  // namespace

void Bounds::add(const Point3& point) {
  lowest = lowest.cwiseMin(point);
  highest = highest.cwiseMax(point);
}

bool Bounds::holds(const Point3& point) const {
  return (lowest.array() <= point.array()).all() && (point.array() <= highest.array()).all();
}

CameraBasis basis_of(const Camera& camera) {
  const Point3 forward = (camera.target - camera.eye).normalized();
  Point3 right = forward.cross(camera.up.normalized());
  // An up along the line of sight says nothing: take the first axis that does.
  if (right.norm() < 1e-9) right = forward.cross(Point3::UnitY());
  if (right.norm() < 1e-9) right = forward.cross(Point3::UnitZ());
  right.normalize();
  return {.right = right, .up = right.cross(forward), .forward = forward};
}

double half_height_slope(const Camera& camera) {
  const SinCos<double> half = sin_cos(0.5 * camera.view_angle_rad);
  return half.sin / half.cos;
}

Camera follow_camera(const Point2& place, const Pose2& T_map_base) {
  const Point2 robot = T_map_base.translation();
  const SinCos<double> heading = sin_cos(T_map_base.theta_rad);
  Point2 ahead(heading.cos, heading.sin);
  if ((robot - place).norm() > 1e-6) ahead = (robot - place).normalized();
  const Point2 target = robot + kFollowAhead_m * ahead;
  Camera camera;
  camera.eye = {place.x(), place.y(), kFollowHeight_m};
  camera.target = {target.x(), target.y(), kFollowLookedAt_m};
  camera.view_angle_rad = kFollowViewAngleRad;
  return camera;
}

Camera turned(const Camera& camera, double angle_rad) {
  const SinCos<double> turn = sin_cos(angle_rad);
  const auto about_z = [&turn](const Point3& v) {
    return Point3(turn.cos * v.x() - turn.sin * v.y(), turn.sin * v.x() + turn.cos * v.y(), v.z());
  };
  Camera result = camera;
  result.eye = camera.target + about_z(camera.eye - camera.target);
  result.up = about_z(camera.up);
  return result;
}

double pixels_per_metre(const Camera& camera, const PictureSize& size, const Point3& point) {
  const double depth_m = basis_of(camera).forward.dot(point - camera.eye);
  if (depth_m <= 0.0) return 0.0;
  if (camera.is_parallel) return size.height / camera.parallel_height_m;
  return 0.5 * size.height / (half_height_slope(camera) * depth_m);
}

std::optional<Seen> pixel_of(const Camera& camera, const PictureSize& size, const Point3& point) {
  const double scale_px = pixels_per_metre(camera, size, point);
  if (scale_px <= 0.0) return std::nullopt;
  const CameraBasis basis = basis_of(camera);
  const Point3 from_eye = point - camera.eye;
  return Seen{.x_px = 0.5 * size.width + scale_px * basis.right.dot(from_eye),
              .y_px = 0.5 * size.height - scale_px * basis.up.dot(from_eye),
              .depth_m = basis.forward.dot(from_eye)};
}

}  // namespace gdtslam

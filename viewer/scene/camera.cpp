// Cameras: their axes, those that show a whole box, and cameras as text. The nearest camera for a direction is exact.
// In the camera's axes a point (u, v, w) is in the picture if |u - a| <= (w + d) t. The least distance d follows from
// the extremes of u - w t and u + w t over the points; likewise for v. Only the shift a is left to choose.
#include "gdtslam/viewer/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <vector>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kFollowHeight_m = 1.9;    // below ceilings, above furniture
constexpr double kFollowLookedAt_m = 0.6;  // above the floor: the picture shows more ahead of the robot than behind it
constexpr double kFollowAhead_m = 0.8;
constexpr double kFollowViewAngleRad = 0.95;

constexpr double kOrbitMarginShare = 0.02;  // corners are there only in passing
constexpr double kMarginShare = 0.06;       // share of the picture, on each side
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

std::vector<Point3> box_corners(const Bounds& box) {
  std::vector<Point3> corners;
  for (const double x : {box.lowest.x(), box.highest.x()}) {
    for (const double y : {box.lowest.y(), box.highest.y()}) {
      for (const double z : {box.lowest.z(), box.highest.z()}) corners.emplace_back(x, y, z);
    }
  }
  return corners;
}

// Distance required by one direction of the picture, with the best shift.
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

// The shift that centres the points between two edges of the picture at this distance. It is exact for the direction
// that determines the distance, which leaves no choice.
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

// Line of sight of the iso camera; the eye is turned west of south by this angle.
Point3 iso_sight(double west_of_south_rad) {
  const SinCos<double> slope = sin_cos(kIsoSlopeRad);
  const SinCos<double> heading = sin_cos(west_of_south_rad);
  return {slope.cos * heading.sin, slope.cos * heading.cos, -slope.sin};
}

Camera iso_camera(const Bounds& box, const PictureSize& size) {
  const std::vector<Point3> corners = box_corners(box);
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
  const CameraBasis basis = camera_basis(camera);
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

constexpr std::string_view kForm = "EYE_X,EYE_Y,EYE_Z,TARGET_X,TARGET_Y,TARGET_Z[,ANGLE]";
constexpr double kFarthest_m = 1e6;

[[noreturn]] void fail_camera(const std::string& text, const std::string& what) {
  throw UsageError(fmt::format("camera '{}': {}; give {}, for example 20,-30,25,0,0,0,35", text, what, kForm));
}

std::vector<std::string_view> split_parts(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = text.find(',', begin);
    std::string_view part = text.substr(begin, comma == std::string_view::npos ? comma : comma - begin);
    while (part.starts_with(' ')) part.remove_prefix(1);
    while (part.ends_with(' ')) part.remove_suffix(1);
    parts.push_back(part);
    if (comma == std::string_view::npos) return parts;
    begin = comma + 1;
  }
}

double read_number(std::string_view part, const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
  if (error != std::errc{} || end != part.data() + part.size())
    fail_camera(text, fmt::format("'{}' is not a number", part));
  if (!(std::fabs(value) <= kFarthest_m))
    fail_camera(text, fmt::format("'{}' is beyond {} km", part, kFarthest_m / 1000.0));
  return value;
}

void read_opening(std::string_view part, const std::string& text, Camera& camera) {
  if (part.ends_with('m')) {
    camera.is_parallel = true;
    camera.parallel_height_m = read_number(part.substr(0, part.size() - 1), text);
    if (camera.parallel_height_m < 0.001) fail_camera(text, "a parallel camera must show at least 0.001 m");
    return;
  }
  const double angle_deg = read_number(part, text);
  if (angle_deg < 0.1 || angle_deg > 170.0) {
    fail_camera(text, fmt::format("the view angle {} is not between 0.1 and 170 degrees", part));
  }
  camera.view_angle_rad = rad_from_deg(angle_deg);
}

}  // namespace

void Bounds::add(const Point3& point) {
  lowest = lowest.cwiseMin(point);
  highest = highest.cwiseMax(point);
}

bool Bounds::holds(const Point3& point) const {
  return (lowest.array() <= point.array()).all() && (point.array() <= highest.array()).all();
}

CameraBasis camera_basis(const Camera& camera) {
  const Point3 forward = (camera.target - camera.eye).normalized();
  Point3 right = forward.cross(camera.up.normalized());
  // If up is along the line of sight, it is replaced by the first axis that is not.
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
  const double depth_m = camera_basis(camera).forward.dot(point - camera.eye);
  if (depth_m <= 0.0) return 0.0;
  if (camera.is_parallel) return size.height / camera.parallel_height_m;
  return 0.5 * size.height / (half_height_slope(camera) * depth_m);
}

std::optional<Point2> project(const Camera& camera, const PictureSize& size, const Point3& point) {
  const double scale_px = pixels_per_metre(camera, size, point);
  if (scale_px <= 0.0) return std::nullopt;
  const CameraBasis basis = camera_basis(camera);
  const Point3 from_eye = point - camera.eye;
  return Point2(0.5 * size.width + scale_px * basis.right.dot(from_eye),
                0.5 * size.height - scale_px * basis.up.dot(from_eye));
}

Camera nearest_camera(const Point3& forward, double view_angle_rad, const Point3& centre,
                      const std::vector<Point3>& points, const PictureSize& size, double margin_share) {
  Camera camera;
  camera.view_angle_rad = view_angle_rad;
  camera.target = centre;
  camera.eye = centre - forward;
  const CameraBasis basis = camera_basis(camera);
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
  constexpr int kDirections = 64;  // around the cylinder swept by the turning box; error at most 0.12 % of its radius
  const Bounds box = shown(bounds);
  const Point3 half = 0.5 * (box.highest - box.lowest);
  const double radius_m = std::sqrt(half.x() * half.x() + half.y() * half.y());
  const Point3 sight = iso_sight(kIsoTurnRad);
  std::vector<Point3> rims;
  for (int k = 0; k < kDirections; ++k) {
    const SinCos<double> direction = sin_cos(kTwoPi * k / kDirections - kIsoTurnRad);  // symmetric on both sides
    for (const double z : {box.lowest.z(), box.highest.z()}) {
      rims.emplace_back(box.centre().x() + radius_m * direction.cos, box.centre().y() + radius_m * direction.sin, z);
    }
  }
  Camera camera = nearest_camera(sight, kIsoViewAngleRad, box.centre(), rims, size, kOrbitMarginShare);
  // Moves the target along the line of sight to the box's axis, about which the camera turns.
  const CameraBasis basis = camera_basis(camera);
  const Point3 level(basis.forward.x(), basis.forward.y(), 0.0);
  camera.target += basis.forward * (level.dot(box.centre() - camera.target) / level.dot(level));
  return camera;
}

Camera parse_camera(const std::string& text) {
  const std::vector<std::string_view> parts = split_parts(text);
  if (parts.size() != 6 && parts.size() != 7) {
    fail_camera(text, fmt::format("{} number{} where 6 or 7 are needed", parts.size(), parts.size() == 1 ? "" : "s"));
  }
  std::array<double, 6> numbers{};
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = read_number(parts[k], text);
  Camera camera;
  camera.eye = {numbers[0], numbers[1], numbers[2]};
  camera.target = {numbers[3], numbers[4], numbers[5]};
  const Point3 sight = camera.target - camera.eye;
  if (sight.norm() < 1e-3) fail_camera(text, "eye and target are at one place");
  const double level_m = std::sqrt(sight.x() * sight.x() + sight.y() * sight.y());
  if (level_m < 1e-6 * sight.norm()) camera.up = Point3::UnitY();
  if (parts.size() == 7) read_opening(parts[6], text, camera);
  return camera;
}

}  // namespace gdtslam

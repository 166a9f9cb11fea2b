// Ramps, plates and sills: their profiles, their limits, and the floor's height.
#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {
namespace {

// A part along a line in the plan; its x axis is the line turned by `turn_rad`.
FloorPart part_along(const Point2& from_m, const Point2& to_m, double turn_rad) {
  const Point2 along = to_m - from_m;
  return {.centre_m = 0.5 * (from_m + to_m),
          .yaw_rad = gdtslam::atan2(along.y(), along.x()) + turn_rad,
          .width_m = 0.0,
          .profile_m = {}};
}

double distance_between(const Point2& a, const Point2& b) {
  const Point2 along = b - a;
  return std::sqrt(along.x() * along.x() + along.y() * along.y());
}

// Parts that touch leave no gap between them: each reaches further than the rounding of a place.
constexpr double kReach_m = 1e-6;

// Empty beyond the part.
std::optional<double> part_height_m(const FloorPart& part, const Point2& place_m) {
  // A quick test first, because most places are far from most parts.
  const double half_length_m = std::max(-part.profile_m.front().x(), part.profile_m.back().x());
  const Point2 off_m = place_m - part.centre_m;
  const double reach_m = half_length_m + part.width_m;
  if (std::fabs(off_m.x()) > reach_m || std::fabs(off_m.y()) > reach_m) return std::nullopt;
  const Point2 p = inverse(Pose2{part.centre_m.x(), part.centre_m.y(), part.yaw_rad}) * place_m;
  const std::vector<Point2>& profile = part.profile_m;
  if (std::fabs(p.y()) > 0.5 * part.width_m + kReach_m) return std::nullopt;
  if (p.x() < profile.front().x() - kReach_m || p.x() > profile.back().x() + kReach_m) return std::nullopt;
  std::size_t next = 1;
  while (next + 1 < profile.size() && profile[next].x() < p.x()) ++next;
  const Point2& a = profile[next - 1];
  const Point2& b = profile[next];
  const double share = std::clamp((p.x() - a.x()) / (b.x() - a.x()), 0.0, 1.0);
  return a.y() + share * (b.y() - a.y());
}

}  // namespace

FloorPart make_ramp(const Vec3& from_m, const Vec3& to_m, double width_m) {
  FloorPart ramp = part_along(from_m.head<2>(), to_m.head<2>(), 0.0);
  const double half_m = 0.5 * distance_between(from_m.head<2>(), to_m.head<2>());
  ramp.width_m = width_m;
  ramp.profile_m = {{-half_m, from_m.z()}, {half_m, to_m.z()}};
  return ramp;
}

FloorPart make_plate(const Point2& centre_m, const Point2& size_m, double yaw_rad, double height_m) {
  const double half_m = 0.5 * size_m.x();
  return {.centre_m = centre_m,
          .yaw_rad = yaw_rad,
          .width_m = size_m.y(),
          .profile_m = {{-half_m, height_m}, {half_m, height_m}}};
}

FloorPart make_sill(const Point2& from_m, const Point2& to_m, double width_m, double height_m, double base_m) {
  constexpr int kPieces = 8;
  FloorPart sill = part_along(from_m, to_m, -0.5 * kPi);
  sill.width_m = distance_between(from_m, to_m);
  for (int k = 0; k <= kPieces; ++k) {
    const double share = static_cast<double>(k) / kPieces;
    const double raised = 0.5 - 0.5 * sin_cos(kTwoPi * share).cos;
    sill.profile_m.emplace_back((share - 0.5) * width_m, base_m + height_m * raised);
  }
  return sill;
}

double floor_height_m(const std::vector<FloorPart>& parts, double floor_m, const Point2& place_m) {
  double height_m = floor_m;
  for (const FloorPart& part : parts) height_m = std::max(height_m, part_height_m(part, place_m).value_or(floor_m));
  return height_m;
}

std::vector<std::string> validate(const FloorPart& part) {
  const auto is_within = [](double value, double least, double most) { return value >= least && value <= most; };
  const auto is_place = [&](double value) { return is_within(value, -kMaxCoordinate_m, kMaxCoordinate_m); };
  std::vector<std::string> faults;
  if (!is_place(part.centre_m.x()) || !is_place(part.centre_m.y()) || !is_within(part.yaw_rad, -1000.0, 1000.0)) {
    faults.emplace_back("its place must lie within 1000 m of the origin");
  }
  if (!is_within(part.width_m, 1e-3, 2.0 * kMaxCoordinate_m)) faults.emplace_back("each side must be 1 mm to 2000 m");
  bool is_ascending = part.profile_m.size() >= 2;
  for (std::size_t i = 0; i < part.profile_m.size(); ++i) {
    is_ascending = is_ascending && (i == 0 || part.profile_m[i].x() - part.profile_m[i - 1].x() >= 1e-4);
    if (!is_place(part.profile_m[i].y())) faults.emplace_back("its height must lie within 1000 m of the origin");
  }
  if (!is_ascending) faults.emplace_back("its length along the profile must be at least 1 mm");
  return faults;
}

}  // namespace gdtslam::sim

// For the tests of drawn linkages: where joints must be, from the law of cosines alone, and where caps are found in a
// picture.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/pose3.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam::testing {

/// Places in the plane of x (forward) and z (up) from the nodding axis: crank's pivot, its end A, the coupler's end B,
/// the rocker's pivot. `sign * angle + offset` is a direction's angle from level, so that the rocker's is the
/// elevation.
inline std::optional<std::array<Point2, 4>> expected_joints(const calib::SweepModel& model, double crank_rad) {
  const calib::FourBar& bars = model.bars;
  const double along = bars.crank_m * std::cos(crank_rad) - bars.ground_m;
  const double up = bars.crank_m * std::sin(crank_rad);
  const double diagonal = std::sqrt(along * along + up * up);
  const double cosine = (diagonal * diagonal + bars.rocker_m * bars.rocker_m - bars.coupler_m * bars.coupler_m) /
                        (2.0 * diagonal * bars.rocker_m);
  if (std::fabs(cosine) > 1.0) return std::nullopt;
  // From the rocker's pivot, A lies at this angle; B lies to the right of the way back there when the linkage is open.
  const double to_a = std::atan2(up, along);
  const double rocker_rad = to_a + (model.assembly == calib::Assembly::kOpen ? -1.0 : 1.0) * std::acos(cosine);
  const auto turned = [&](double length, double angle_rad) -> Point2 {
    const double angle = model.elevation_sign * angle_rad + model.elevation_offset_rad;
    return {length * std::cos(angle), length * std::sin(angle)};
  };
  const Point2 crank_pivot = -turned(bars.ground_m, 0.0);
  return std::array<Point2, 4>{crank_pivot, Point2(crank_pivot + turned(bars.crank_m, crank_rad)),
                               turned(bars.rocker_m, rocker_rad), Point2::Zero()};
}

/// Middle of the white cap whose ring surrounds the place; nothing where less than half of a disc of that radius is
/// white.
inline std::optional<Point2> cap_near(const RgbaImage& image, const Point2& at, double radius_px) {
  Point2 sum = Point2::Zero();
  int count = 0;
  const int reach = static_cast<int>(std::ceil(radius_px)) + 2;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const Point2 place(std::floor(at.x()) + x, std::floor(at.y()) + y);
      if (place.x() < 0 || place.y() < 0 || place.x() >= image.width || place.y() >= image.height) continue;
      const std::uint8_t* pixel =
          image.at(static_cast<std::uint32_t>(place.x()), static_cast<std::uint32_t>(place.y()));
      if (pixel[0] < 235 || pixel[1] < 235 || pixel[2] < 230) continue;
      sum += place + Point2(0.5, 0.5);
      ++count;
    }
  }
  if (count < 0.5 * 3.14 * radius_px * radius_px) return std::nullopt;
  return Point2(sum / count);
}

}  // namespace gdtslam::testing

// Where the joints of a linkage must be, from the law of cosines alone.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "gdtslam/calib/sweep_model.hpp"

namespace gdtslam::test {

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

}  // namespace gdtslam::test

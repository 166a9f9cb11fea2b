// Directions of a scan's beams, its valid ranges, and the beams as segments through the cells of a grid, each from the
// laser's position when it measured. Frame: the grid's, whose cell (0, 0) has its lower left corner at the origin;
// metres in, cells out. Thread-safe. Cost: O(beams).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "scan_marks.hpp"
#include "store/growth.hpp"

namespace gdtslam {

/// Farther from the robot neither sensors nor points count: such a mount is plainly wrong.
inline constexpr double kFurthestFromRobot_m = 1.0e5;

inline double beam_bearing_rad(const LaserScan& scan, std::size_t beam) {
  return scan.first_bearing_rad + static_cast<double>(beam) * scan.bearing_step_rad;
}

/// Sine and cosine of a beam's bearing in the laser's frame.
inline SinCos<double> beam_direction(const LaserScan& scan, std::size_t beam) {
  return sin_cos(beam_bearing_rad(scan, beam));
}

/// True if the laser is known to have moved between the beams of the scan.
inline bool is_skewed(const LaserScan& scan) {
  return scan.speed && (scan.first_beam_after_s != 0.0 || scan.beam_period_s != 0.0);
}

/// Pose of the laser when it measured the beam, in the robot's frame at the scan's stamp.
inline Pose2 laser_at_beam(const LaserScan& scan, std::size_t beam) {
  const double after_s = scan.first_beam_after_s + static_cast<double>(beam) * scan.beam_period_s;
  return exp_se2(after_s * *scan.speed) * scan.T_base_laser;
}

/// At or above it a range is no return: the configured limit, or the sensor's own if that is lower.
inline double range_limit_m(const LaserScan& scan, double most_m) {
  return limit_of_floats_m(scan.max_range_m > 0.0 ? std::min(most_m, scan.max_range_m) : most_m);
}

/// A beam from the laser to its end; without a return, to the end of its free space.
struct ScanRay {
  SubCell start;
  SubCell end;       ///< the return, or the end of the known free space
  SubCell free_end;  ///< end of the part that counts as passed; `end` unless rays are cut short
  bool is_return = false;
  std::uint32_t beam = 0;  ///< its number in the scan
};

struct RayLimits {
  double resolution_m = 0.05;
  double min_range_m = 0.0;       ///< shorter ranges are dropped
  double max_range_m = 0.0;       ///< at or above it, or the sensor's own limit, a range is no return
  double no_return_free_m = 0.0;  ///< length of a beam without return; 0: there is none
  double short_of_end_m = 0.0;    ///< length before its end that does not count as passed
};

/// Unit vectors of the beams in the laser's frame.
inline std::vector<Point2> beam_directions(const LaserScan& scan) {
  std::vector<Point2> directions;
  directions.reserve(scan.ranges_m.size());
  for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
    const auto [sine, cosine] = beam_direction(scan, k);
    directions.emplace_back(cosine, sine);
  }
  return directions;
}

/// The nearest odd multiple of 1/512 cell, limited to the range of map cells.
inline SubCell to_sub_cell(const Point2& point_m, double resolution_m) {
  constexpr double kEvenSteps = 256.0;
  const auto odd = [resolution_m](double coordinate_m) {
    const double steps = std::floor(coordinate_m / resolution_m * kEvenSteps);
    constexpr double kFurthest = static_cast<double>(kFurthestCell) * kEvenSteps;
    return 2 * static_cast<std::int64_t>(std::clamp(steps, -kFurthest, kFurthest)) + 1;
  };
  return {odd(point_m.x()), odd(point_m.y())};
}

/// A pose with its sine and cosine, which each beam needs.
struct TurnedLaser {
  explicit TurnedLaser(const Pose2& T) : T_grid_laser(T), heading(sin_cos(T.theta_rad)) {}
  [[nodiscard]] Point2 in_grid(const Point2& d) const {
    return {T_grid_laser.x_m + heading.cos * d.x() - heading.sin * d.y(),
            T_grid_laser.y_m + heading.sin * d.x() + heading.cos * d.y()};
  }
  Pose2 T_grid_laser;
  SinCos<double> heading;
};

/// Replaces `rays` by those of the scan, whose beams point along `directions`; returns the cells that they touch.
/// Ranges that are not finite are no returns. Throws InputError if the laser's pose is not finite.
template <class Ray>
CellBox collect_rays(const LaserScan& scan, const Pose2& T_grid_base, std::span<const Point2> directions,
                     const RayLimits& limits, std::vector<Ray>& rays) {
  const auto cell_box = [](CellIndex cell) { return CellBox{cell, cell + CellOffset{1, 1}}; };
  const double limit_m = range_limit_m(scan, limits.max_range_m);
  const bool moved = is_skewed(scan);
  TurnedLaser laser(T_grid_base * scan.T_base_laser);
  if (!laser.T_grid_laser.is_finite()) throw InputError("a scan of the occupancy map has a pose that is not finite");
  SubCell start = to_sub_cell(laser.T_grid_laser.translation(), limits.resolution_m);
  CellBox touched;
  rays.clear();
  for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
    const auto range_m = static_cast<double>(scan.ranges_m[k]);
    if (range_m < limits.min_range_m) continue;
    const bool is_return = range_m < limit_m;  // false for NaN and infinity
    const double length_m = is_return ? range_m : std::min(limits.no_return_free_m, limit_m);
    if (!(length_m > 0.0)) continue;
    if (moved) {
      laser = TurnedLaser(T_grid_base * laser_at_beam(scan, k));
      start = to_sub_cell(laser.T_grid_laser.translation(), limits.resolution_m);
    }
    const Point2 end_m = laser.in_grid(directions[k] * length_m);
    if (!end_m.allFinite()) continue;
    if (moved || rays.empty()) touched = bounding_box(touched, cell_box(start.cell()));
    Ray ray;
    ray.start = start;
    ray.end = ray.free_end = to_sub_cell(end_m, limits.resolution_m);
    ray.is_return = is_return;
    ray.beam = static_cast<std::uint32_t>(k);
    if (limits.short_of_end_m > 0.0) {
      const Point2 free_end_m = laser.in_grid(directions[k] * std::max(0.0, length_m - limits.short_of_end_m));
      ray.free_end = to_sub_cell(free_end_m, limits.resolution_m);
    }
    rays.push_back(ray);
    touched = bounding_box(touched, cell_box(ray.end.cell()));
  }
  return touched;
}

}  // namespace gdtslam

// Where the beams of a scan point and which of its ranges count. Thread-safe.
#pragma once

#include <algorithm>
#include <cstddef>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// Farther from the robot neither sensor nor points count: a mount that is plainly wrong.
inline constexpr double kFurthestFromRobot_m = 1.0e5;

inline double beam_bearing_rad(const LaserScan& scan, std::size_t beam) {
  return scan.first_bearing_rad + static_cast<double>(beam) * scan.bearing_step_rad;
}

/// Sine and cosine of a beam's bearing in the laser's frame.
inline SinCos<double> beam_direction(const LaserScan& scan, std::size_t beam) {
  return sin_cos(beam_bearing_rad(scan, beam));
}

/// Whether the laser is known to have moved between the beams of the scan.
inline bool is_skewed(const LaserScan& scan) {
  return scan.speed && (scan.first_beam_after_s != 0.0 || scan.beam_period_s != 0.0);
}

/// The laser when it measured the beam, in the robot's frame at the scan's stamp.
inline Pose2 laser_at_beam(const LaserScan& scan, std::size_t beam) {
  const double after_s = scan.first_beam_after_s + static_cast<double>(beam) * scan.beam_period_s;
  return exp_se2(after_s * *scan.speed) * scan.T_base_laser;
}

/// At or above it a range is no return: the configured limit, or the sensor's own where that is lower.
inline double range_limit_m(const LaserScan& scan, double most_m) {
  return scan.max_range_m > 0.0 ? std::min(most_m, scan.max_range_m) : most_m;
}

}  // namespace gdtslam

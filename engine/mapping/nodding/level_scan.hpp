// A scan of a nodding laser near horizontal as the 2D system wants it: the points' places over the floor, each beam
// with its own elevation, equation (12), and where the odometry tells the robot's motion during the scan, corrected for
// it. Frame: the robot at the scan's stamp. Thread-safe; linear in the beams.
#pragma once

#include <limits>
#include <optional>

#include "gdtslam/mapping/scan_points.hpp"
#include "sweep_assembler.hpp"

namespace gdtslam {

/// Heights over the sensor's place at elevation zero.
struct HeightBand {
  double low_m = -std::numeric_limits<double>::infinity();
  double high_m = std::numeric_limits<double>::infinity();
};

/// `before`: odometry of the scan before this one. Points outside the band are left out.
PointScan level_points(const NoddingScan& scan, const NoddingScanner& scanner, const ScanConfig& valid,
                       const std::optional<Odometry>& before, const HeightBand& band = {});
/// The same scan as ranges over the floor, for the occupancy map; what the sensor calls no return stays so; bearings
/// stay, which is exact at elevation zero and off by less than 0.01 deg within 1 deg of it.
LaserScan level_scan(const NoddingScan& scan, const NoddingScanner& scanner);

}  // namespace gdtslam

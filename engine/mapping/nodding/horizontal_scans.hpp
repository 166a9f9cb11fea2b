// Selects the near-horizontal scans of a nodding laser, levels them for the 2D system, and records the elevations of
// all scans: strokes, and the range seen. One object belongs to one thread; linear in the beams.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "sweep_assembler.hpp"

namespace gdtslam {

// Levels a near-horizontal scan of a nodding laser for the 2D system: the points' positions over the floor, each beam
// with its own elevation, equation (12). If the odometry gives the robot's motion during the scan, the points are
// corrected for it. Frame: the robot at the scan's stamp. Thread-safe; linear in the beams.

/// Heights over the sensor's position at elevation zero.
struct HeightBand {
  double low_m = -std::numeric_limits<double>::infinity();
  double high_m = std::numeric_limits<double>::infinity();
};

/// `before`: odometry of the scan before this one. Points outside the band are left out.
PointScan level_points(const NoddingScan& scan, const NoddingScanner& scanner, const ScanConfig& valid,
                       const std::optional<Odometry>& before, const HeightBand& band = {});
/// The same scan as ranges over the floor, for the occupancy map; beams without return stay so. Bearings are kept,
/// which is exact at elevation zero and off by less than 0.01 deg within 1 deg of it.
LaserScan level_scan(const NoddingScan& scan, const NoddingScanner& scanner);

struct ElevationRange {
  double low_rad = std::numeric_limits<double>::infinity();
  double high_rad = -std::numeric_limits<double>::infinity();
};

class HorizontalScans {
 public:
  /// `valid` gives the limits of valid ranges.
  HorizontalScans(const NoddingConfig& config, const NoddingScanner& scanner, const ScanConfig& valid);
  /// Takes the next scan in log order. If all its elevations lie within the tolerance, returns its points over the
  /// floor, robot frame at the scan's stamp.
  std::optional<PointScan> take(const NoddingScan& scan);
  /// Strokes of the mount so far, up or down.
  [[nodiscard]] std::uint64_t strokes() const { return strokes_; }
  /// Throws InputError with the reason why no scan was horizontal.
  [[noreturn]] void throw_none() const;

 private:
  void note_stroke(double elevation_rad);

  double horizontal_rad_;
  NoddingScanner scanner_;
  ScanConfig valid_;
  std::optional<Odometry> last_odometry_;  ///< odometry of the previous scan
  ElevationRange seen_;
  std::optional<double> last_elevation_rad_;
  int stroke_ = 0;  ///< +1 up, -1 down
  std::uint64_t strokes_ = 0;
  bool is_elevation_known_ = false;  ///< true once any scan had one
};

/// The odometry of every scan without steps that are too long to be true. The 2D system sees only that of horizontal
/// scans, which lie metres apart, so it cannot distinguish a leap from a drive.
class SteadyOdometry {
 public:
  explicit SteadyOdometry(double max_step_m) : max_step_m_(max_step_m) {}
  /// Takes the odometry of the next scan. During a leap the robot stands, and later motion continues from there; before
  /// any leap the result is the input, bit for bit. Empty if it is not finite.
  std::optional<Pose2> take(const std::optional<Pose2>& T_odom_base);
  [[nodiscard]] std::uint64_t leaps() const { return leaps_; }

 private:
  double max_step_m_;
  std::optional<Pose2> T_odom_last_;  // last odometry given
  std::optional<Pose2> T_steady_odom_;
  std::uint64_t leaps_ = 0;
};

}  // namespace gdtslam

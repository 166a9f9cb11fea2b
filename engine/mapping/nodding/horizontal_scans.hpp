// The scans of a nodding laser that are near horizontal, levelled for the 2D system, and what the elevations of all
// scans were: strokes, and the range that was seen. One object belongs to one thread; linear in the beams.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "sweep_assembler.hpp"

namespace gdtslam {

// A scan of a nodding laser near horizontal as the 2D system wants it: the points' places over the floor, each beam
// with its own elevation, equation (12), and where the odometry tells the robot's motion during the scan, corrected for
// it. Frame: the robot at the scan's stamp. Thread-safe; linear in the beams.

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

struct ElevationRange {
  double low_rad = std::numeric_limits<double>::infinity();
  double high_rad = -std::numeric_limits<double>::infinity();
};

class HorizontalScans {
 public:
  /// `valid`: which ranges count.
  HorizontalScans(const NoddingConfig& config, const NoddingScanner& scanner, const ScanConfig& valid);
  /// The next scan in log order: its points over the floor, robot frame at the scan's stamp, where all its elevations
  /// lie within the tolerance; else nothing.
  std::optional<PointScan> take(const NoddingScan& scan);
  /// Strokes of the mount so far, up or down.
  [[nodiscard]] std::uint64_t strokes() const { return strokes_; }
  /// Throws InputError that says why none of the scans was horizontal.
  [[noreturn]] void throw_none() const;

 private:
  void note_stroke(double elevation_rad);

  double horizontal_rad_;
  NoddingScanner scanner_;
  ScanConfig valid_;
  std::optional<Odometry> last_odometry_;  ///< odometry of the scan before the one in hand
  ElevationRange seen_;
  std::optional<double> last_elevation_rad_;
  int stroke_ = 0;  ///< +1 up, -1 down
  std::uint64_t strokes_ = 0;
  bool is_elevation_known_ = false;  ///< true once any scan had one
};

/// The odometry of every scan without steps that are too long to be true: the 2D system sees that of horizontal scans
/// alone, between which metres lie, and could not tell a leap from a drive.
class SteadyOdometry {
 public:
  explicit SteadyOdometry(double max_step_m) : max_step_m_(max_step_m) {}
  /// The next scan's. Over a leap the robot stands, and what follows goes on from there; until then it is what was
  /// given, bit for bit. Nothing where it is not finite.
  std::optional<Pose2> take(const std::optional<Pose2>& T_odom_base);
  [[nodiscard]] std::uint64_t leaps() const { return leaps_; }

 private:
  double max_step_m_;
  std::optional<Pose2> T_odom_last_;  // odometry that was given last
  std::optional<Pose2> T_steady_odom_;
  std::uint64_t leaps_ = 0;
};

}  // namespace gdtslam

// The records of a log of any format. Times are seconds since the epoch of the log, in the log's own clock. The order
// of the records counts, not their stamps.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// A limit for comparison with ranges in float32: there 5.6 m is 5.5999999 m, which still counts as at the limit.
inline double limit_of_floats_m(double limit_m) {
  return std::min(limit_m, static_cast<double>(static_cast<float>(limit_m)));
}

/// One sweep of the laser. Beam k points to first_bearing_rad + k * bearing_step_rad in the laser's frame.
struct LaserScan {
  double stamp_s = 0.0;
  double first_bearing_rad = 0.0;
  double bearing_step_rad = 0.0;
  double max_range_m = 0.0;  ///< a range at or above it means no return; 0 if the log states none
  /// Beam k was measured at stamp_s + first_beam_after_s + k * beam_period_s. All at stamp_s if the log does not state
  /// times.
  double first_beam_after_s = 0.0;
  double beam_period_s = 0.0;  ///< negative if the last beam was measured first
  /// The robot's motion during the scan: tangent (x, y, theta) a second in its own frame. None: treated as standing.
  std::optional<Eigen::Vector3d> speed{};
  std::vector<float> ranges_m;
  Pose2 T_base_laser;
  /// True if the sensor reports by this range that there was no return.
  [[nodiscard]] bool is_at_limit(double range_m) const {
    return max_range_m > 0.0 && range_m >= limit_of_floats_m(max_range_m);
  }
};

/// The same scan from its last beam to its first.
inline void turn_beams_round(LaserScan& scan) {
  if (scan.ranges_m.empty()) return;
  const auto steps = static_cast<double>(scan.ranges_m.size() - 1);
  scan.first_bearing_rad += steps * scan.bearing_step_rad;
  scan.bearing_step_rad = -scan.bearing_step_rad;
  scan.first_beam_after_s += steps * scan.beam_period_s;
  scan.beam_period_s = -scan.beam_period_s;
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
}

/// The robot's pose in the odometry frame, as measured by its wheels.
struct Odometry {
  double stamp_s = 0.0;
  Pose2 T_odom_base;
};

/// A scan with the odometry in its line, if any.
struct ScanRecord {
  LaserScan scan;
  std::optional<Pose2> T_odom_base;
  std::size_t laser = 0;  ///< number of the laser on the robot, in the order of their first scans
};

/// Position of the crank.
struct Encoder {
  double stamp_s = 0.0;
  std::int64_t ticks = 0;
};

/// Elevation of the scan plane, measured directly.
struct Tilt {
  double stamp_s = 0.0;
  double elevation_rad = 0.0;
};

/// A named value of the log, as text.
struct Parameter {
  std::string name;
  std::string value;
};

using LogRecord = std::variant<ScanRecord, Odometry, Encoder, Tilt, Parameter>;

/// The robot's pose in the map, with its time.
struct StampedPose {
  double stamp_s = 0.0;
  Pose2 T_map_base;
};

/// Poses in log order.
using Trajectory = std::vector<StampedPose>;

/// Length of the path from pose to pose, metres, without the gaps between drives: `drives` has the indices of the first
/// poses of further drives, ascending.
double path_length_m(const Trajectory& trajectory, std::span<const std::size_t> drives = {});

/// The verified pose of the robot at time t2 in its frame at time t1.
struct Relation {
  double t1_s = 0.0;
  double t2_s = 0.0;
  Pose2 T_1_2;
};

/// The source of a log's records in order; memory is independent of the log's length.
class LogReader {
 public:
  LogReader() = default;
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;
  virtual ~LogReader() = default;
  /// The next record; none at the end. Throws InputError or FileError.
  virtual std::optional<LogRecord> next() = 0;
  /// Share of the input read so far, 0 to 1, for progress; negative when unknown.
  [[nodiscard]] virtual double progress() const = 0;
  /// Warnings so far, counted by kind (lines or messages that were skipped or corrected).
  struct Warning {
    std::string kind;
    std::uint64_t count = 0;
    std::string first;  ///< place and text of the first one
  };
  [[nodiscard]] virtual const std::vector<Warning>& warnings() const = 0;
};

}  // namespace gdtslam

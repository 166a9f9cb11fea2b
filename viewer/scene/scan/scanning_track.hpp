// A time range of a log with a nodding laser: points sorted by time, the elevation and its direction, the robot's pose.
// Times in the log's clock, seconds; frame map. Thread-safe after construction.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class ScanningTrack {
 public:
  /// `from_s` is before `to_s`, and the cloud has points in between. O(n log n). Throws InputError without poses.
  ScanningTrack(std::span<const CloudPoint> cloud, const Trajectory& trajectory, double from_s, double to_s);

  [[nodiscard]] double from_s() const { return from_s_; }
  [[nodiscard]] double to_s() const { return to_s_; }
  /// Points of the time range, by time.
  [[nodiscard]] std::span<const CloudPoint> points() const { return points_; }
  /// Number of points up to that time, inclusive.
  [[nodiscard]] std::size_t count_until(double stamp_s) const;
  [[nodiscard]] std::span<const CloudPoint> measured_between(double after_s, double until_s) const;
  /// The last complete scan at that time; empty before the first one.
  [[nodiscard]] std::span<const CloudPoint> last_scan(double stamp_s) const;

  /// Interpolated between the points before and after, if there are any.
  [[nodiscard]] double elevation_rad(double stamp_s) const;
  [[nodiscard]] bool is_rising(double stamp_s) const;
  /// Interpolated between the poses before and after.
  [[nodiscard]] Pose2 T_map_base(double stamp_s) const;
  /// Averaged over some seconds, for a camera that follows without jerks.
  [[nodiscard]] Pose2 T_map_base_smooth(double stamp_s) const;

  /// Distance of the sensor ahead of the robot's origin, estimated from the points: a scan's points are in a plane
  /// through the sensor with the elevation as slope. 0 if there are too few points or they disagree.
  [[nodiscard]] double sensor_forward_m(const NoddingMount& mount) const;
  /// Median horizontal distance of the points from the robot.
  [[nodiscard]] double usual_range_m() const;

 private:
  double from_s_;
  double to_s_;
  Cloud points_;
  std::vector<StampedPose> poses_;
};

}  // namespace gdtslam

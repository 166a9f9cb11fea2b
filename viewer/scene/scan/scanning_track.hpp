// Course of a stretch of a log with a nodding laser: points in the order of time, the elevation and whether it rises,
// the robot's pose. Times in the log's clock, seconds; frame map. Thread-safe after construction.
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
  /// `from_s` is before `to_s`, and the cloud has points between. O(n log n). Throws InputError without poses.
  ScanningTrack(std::span<const CloudPoint> cloud, const Trajectory& trajectory, double from_s, double to_s);

  [[nodiscard]] double from_s() const { return from_s_; }
  [[nodiscard]] double to_s() const { return to_s_; }
  /// Points of the stretch, by time.
  [[nodiscard]] std::span<const CloudPoint> points() const { return points_; }
  /// Measured until then, that moment included.
  [[nodiscard]] std::size_t count_until(double stamp_s) const;
  [[nodiscard]] std::span<const CloudPoint> measured_between(double after_s, double until_s) const;
  /// The last scan that was complete then; none before the first was.
  [[nodiscard]] std::span<const CloudPoint> last_scan(double stamp_s) const;

  /// Between the points before and after, as far as there are any.
  [[nodiscard]] double elevation_rad(double stamp_s) const;
  [[nodiscard]] bool is_rising(double stamp_s) const;
  /// Between the poses before and after.
  [[nodiscard]] Pose2 T_map_base(double stamp_s) const;
  /// Averaged over some seconds, for a camera that follows without jerks.
  [[nodiscard]] Pose2 T_map_base_smooth(double stamp_s) const;

  /// How far before the robot's origin the sensor sits, read off the points: those of a scan lie in a plane through the
  /// sensor whose slope is the elevation. 0 where too few points tell, or they disagree.
  [[nodiscard]] double sensor_forward_m(const NoddingMount& mount) const;
  /// Half of the points are at most so far from the robot, level.
  [[nodiscard]] double usual_range_m() const;

 private:
  double from_s_;
  double to_s_;
  Cloud points_;
  std::vector<StampedPose> poses_;
};

}  // namespace gdtslam

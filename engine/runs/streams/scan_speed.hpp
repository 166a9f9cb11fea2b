// How the robot moves while its laser measures a scan whose beams come one after the other: as it moved from the scan
// before to this one, by odometry or, where there is none, by the poses of the map. Not thread-safe; constant time.
#pragma once

#include <optional>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// Tangent (x, y, theta) a second from one pose to the next; nothing where time does not go on, or too far for a robot:
/// more than a second, 30 m/s or two turns a second.
std::optional<Eigen::Vector3d> speed_between(const Odometry& before, const Odometry& now);

/// Gives scans the speed of the robot by odometry where their readers did not. Each laser has the scan before of its
/// own, so that two that fire at almost the same time do not divide by almost nothing.
class OdometrySpeed {
 public:
  void complete(ScanRecord& scan);
  /// What was odometry so far has ended: another log begins.
  void reset() { before_.clear(); }

 private:
  std::vector<std::optional<Odometry>> before_;  ///< by laser
};

/// Likewise by the map's poses, for scans that still have none.
class MapSpeed {
 public:
  void complete(LaserScan& scan) const;
  void take(const StampedPose& pose);

 private:
  std::optional<Odometry> last_;
  std::optional<Eigen::Vector3d> speed_;
};

}  // namespace gdtslam

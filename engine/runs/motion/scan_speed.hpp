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
  /// Forgets the odometry so far: another log begins.
  void reset() { before_.clear(); }

 private:
  std::vector<std::optional<Odometry>> before_;  ///< by laser
};

/// Gives scans without a speed one by the map's poses: from the middle of one sweep to that of the next of the
/// same laser. There a scan is where it is, whatever speed it was given; from stamp to stamp each speed would make the
/// next one.
class MapSpeed {
 public:
  void complete(ScanRecord& record) const;
  /// The scan as it was matched.
  void take(const ScanRecord& record, const Pose2& T_map_base);

 private:
  struct OfLaser {
    std::optional<Odometry> last;
    std::optional<Eigen::Vector3d> speed;
  };
  std::vector<OfLaser> lasers_;
};

}  // namespace gdtslam

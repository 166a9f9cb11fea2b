// Speed of the robot during a scan whose beams are measured one after the other: its motion since the previous scan, by
// odometry or else by the poses of the map. Not thread-safe; constant time.
#pragma once

#include <optional>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// Tangent (x, y, theta) a second from one pose to the next; none if time does not advance, or if the step is too large
/// for a robot: more than a second, 30 m/s or two turns a second.
std::optional<Eigen::Vector3d> speed_between(const Odometry& before, const Odometry& now);

/// Gives scans without a speed the robot's speed by odometry. Each laser has its own previous scan, so that two lasers
/// with almost equal stamps do not divide by almost zero.
class OdometrySpeed {
 public:
  void complete(ScanRecord& scan);
  /// Forgets the odometry so far: another log begins.
  void reset() { before_.clear(); }

 private:
  std::vector<std::optional<Odometry>> before_;  ///< by laser
};

/// Gives scans without a speed one by the map's poses, from the middle of one sweep to the middle of the next of the
/// same laser. The pose at the middle does not depend on the speed given to the scan; from stamp to stamp each speed
/// would affect the next.
class MapSpeed {
 public:
  void complete(ScanRecord& record) const;
  /// Takes a matched scan and its pose.
  void take(const ScanRecord& record, const Pose2& T_map_base);

 private:
  struct OfLaser {
    std::optional<Odometry> last;
    std::optional<Eigen::Vector3d> speed;
  };
  std::vector<OfLaser> lasers_;
};

}  // namespace gdtslam

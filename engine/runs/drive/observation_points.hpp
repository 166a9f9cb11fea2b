// The scans of an observation as one scan: each is placed at the robot's pose at its stamp, by the odometry between the
// stamps; without odometry by the last motion of the map's poses. Frame: the robot at the stamp of the last scan. Not
// thread-safe; linear in the beams.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {

/// A scan in its observation.
struct ObservedScan {
  Pose2 T_last_scan;  ///< the robot's pose at this scan, relative to its pose at the last scan
  bool is_last = true;
};

class ObservationPoints {
 public:
  explicit ObservationPoints(const ScanConfig& valid) : valid_(valid) {}

  /// The robot's pose at each of its scans.
  [[nodiscard]] std::vector<ObservedScan> place(const Observation& observation);
  /// All returns as one scan. Lasers without a scan in the map come last, as its unknown points.
  [[nodiscard]] PointScan points(const Observation& observation, const std::vector<ObservedScan>& places);
  /// Takes the match of the observation. Without odometry its motion is known only now, so scans placed by the previous
  /// motion are placed again.
  void take(const Observation& observation, const MatchResult& match, std::vector<ObservedScan>& places);

 private:
  struct Laser {
    std::optional<ScanPoints> points;
    bool is_in_map = false;
  };
  Laser& find_laser(std::size_t number);
  [[nodiscard]] Pose2 T_last_scan(const ScanRecord& last, const ScanRecord& scan) const;
  void see_odometry(const Observation& observation);

  ScanConfig valid_;
  std::vector<Laser> lasers_;
  std::optional<Pose2> T_odom_first_;
  bool has_odometry_ = false;     ///< logs without odometry repeat one pose
  std::optional<Odometry> last_;  ///< pose of the last observation, in the map
  std::optional<Eigen::Vector3d> speed_;
};

/// The match of an observation, moved to the stamp and the pose of one of its scans.
MatchResult match_of_scan(const MatchResult& match, const ScanRecord& scan, const ObservedScan& place);

/// Turns a path of observations into a path of their scans: each scan has a pose, a keyframe is all scans of its
/// observation, and places and relations use its last scan. `scans`: the scans of all observations in order.
ClosedPath path_of_scans(ClosedPath path, std::span<const ObservedScan> scans);

}  // namespace gdtslam

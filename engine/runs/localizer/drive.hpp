// A drive of a log followed in a map that stays as it is: RobotTracker over every scan, with the reference's word on
// each. Frames: robot in the map, metres and radians. One drive belongs to one thread. Cost: that of the tracker, below
// a millisecond a scan while the robot is known, some tenths of a second for a search of the whole map.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/config.hpp"
#include "run.hpp"
#include "scans.hpp"
#include "tracking.hpp"

namespace gdtslam {

/// What the reference says of a scan that was followed.
struct TrackReference {
  Pose2 T_map_base;
  double known_share = 0.0;  ///< of the scan's points: those that it puts near an obstacle of the map
  double distance_m = 0.0;   ///< of the pose from it; 0 where none is known, as the angle
  double angle_rad = 0.0;    ///< absolute
  bool is_within = false;    ///< there is a pose, and it is within the limits
  /// Whether the map has the place: what it does not have of the scan would not by itself be a poor fit.
  bool is_mapped = false;
};

struct TrackedScan {
  std::uint64_t index = 0;  ///< in the log
  double stamp_s = 0.0;
  TrackedPose pose;
  bool is_searched = false;  ///< the whole map was searched for it
  double wall_s = 0.0;       ///< what it took
  std::optional<TrackReference> reference;
};

struct TrackedDrive {
  std::vector<TrackedScan> scans;  ///< in the log's order; of a live log none: it may go on for days
  std::uint64_t followed = 0;      ///< scans
  bool nods = false;               ///< the log tells how a mount tilts the laser
  std::vector<LogReader::Warning> warnings;
  bool interrupted = false;
};

/// Called with each scan, its ranges and what was found of it.
using ScanFollowed = std::function<void(const LaserScan&, const TrackedPose&)>;

/// Follows the log from scan `job.choice.first` on; the rest of the choice does not count. `cpu` must be the CPU. Ends
/// early when stop() is true. Throws InputError, also where no scan is left; FileError, DeviceError, ConfigError.
TrackedDrive track_drive(const LocalizeJob& job, const Localizer& localizer, const MapperConfig& config, Backend& cpu,
                         const LocalizeProgress& progress, const std::function<bool()>& stop,
                         const ScanFollowed& followed = {});

}  // namespace gdtslam

// A drive of a log followed in a map that stays as it is: RobotTracker over every scan. Frames: robot in the map,
// metres and radians. One drive belongs to one thread. Cost: that of the tracker, below a millisecond a scan while the
// robot is known, some tenths of a second for a search of the whole map.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/config.hpp"
#include "run.hpp"
#include "scans.hpp"
#include "tracking.hpp"

namespace gdtslam {

struct TrackedScan {
  std::uint64_t index = 0;  ///< in the log
  double stamp_s = 0.0;
  TrackedPose pose;
};

struct TrackedDrive {
  std::vector<TrackedScan> scans;  ///< in the log's order; of a live log none: it may go on for days
  std::uint64_t followed = 0;      ///< scans
  std::uint64_t searches = 0;      ///< of the whole map
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

// The scans of a log that are localised, all of them at once: scans do not depend on each other, so several threads
// take them, and the result is in the log's order whatever their number. One run belongs to one thread.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/mapping/changes/map_changes.hpp"
#include "engine/runs/localizer/map_field.hpp"
#include "engine/runs/localizer/run.hpp"
#include "engine/runs/localizer/tracking.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

/// One scan, or every so many of them.
struct ScanChoice {
  std::uint64_t first = 0;  ///< index in the log
  std::uint64_t every = 0;  ///< 0: the first alone
};

struct LocalizeJob {
  std::string log;
  /// Input of a drive that is followed while it goes on, in place of the file with the log's name: nothing is read
  /// ahead to see whether the laser nods.
  LiveLog live_log{};
  ReadOptions read;
  ScanChoice choice;
  unsigned threads = 1;  ///< threads of the CPU; a device takes one scan after the other
};

struct Localized {
  std::vector<LocalizedScan> scans;  ///< in the log's order
  bool nods = false;                 ///< the log tells how a mount tilts the laser
  std::vector<LogReader::Warning> warnings;
  bool interrupted = false;
};

/// Called with the number of scans done and the share (negative when unknown).
using LocalizeProgress = std::function<void(std::uint64_t, double)>;
/// Ends early when stop() is true, after the scans in hand. Throws InputError, FileError, DeviceError.
Localized localize_scans(const LocalizeJob& job, const Localizer& localizer, const LocalizeProgress& progress,
                         const std::function<bool()>& stop);

// A drive of a log followed in a map that stays as it is: RobotTracker over every scan. Frames: robot in the map,
// metres and radians. One drive belongs to one thread. Cost: that of the tracker, below a millisecond a scan while the
// robot is known, some tenths of a second for a search of the whole map.

struct TrackedScan {
  std::uint64_t index = 0;  ///< in the log
  double stamp_s = 0.0;
  TrackedPose pose;
};

struct TrackedDrive {
  std::vector<TrackedScan> scans;  ///< in the log's order; of a live log none: it may go on for days
  std::uint64_t followed = 0;      ///< scans
  std::uint64_t searches = 0;      ///< searches of the whole map
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

// Found poses as a table for `gdtslam evaluate` and other programs: the names of the columns, then one line a scan
// (docs/formats.md). Thread-safe; O(scans).

/// For programs: "poor-fit".
std::string json_name(Verdict verdict);

std::string table_text(const std::vector<LocalizedScan>& scans);
std::string table_text(const TrackedDrive& drive);

/// Scans by verdict, in the order of kVerdicts; by whereabouts, in the order of kWhereabouts.
std::array<std::uint64_t, kVerdicts.size()> count_verdicts(const std::vector<LocalizedScan>& scans);
std::array<std::uint64_t, kWhereabouts.size()> count_whereabouts(const TrackedDrive& drive);

// Changes in a map that a drive in it shows. Only scans count that were matched well while the
// robot was followed, in no doubt about where that is. Frame: the map's, metres. One object belongs to one thread.
// Cost: engine/mapping/changes.

class DriveChanges {
 public:
  /// In the map that the field belongs to; where that is a run's, the scans that it was made from count, too. Throws
  /// InputError where it is a run's that has no map.pgm, FileError.
  DriveChanges(const MapField& field, const MapperConfig& config, const ChangeLimits& limits);

  /// The next scan of the drive. Throws InputError.
  void see(const LaserScan& scan, const TrackedPose& pose);

  [[nodiscard]] const OccupancyMap& map() const { return map_; }
  [[nodiscard]] const ChangeLimits& limits() const { return limits_; }
  [[nodiscard]] std::size_t views() const { return views_.views(); }
  /// Places where they were taken, in stretches without a gap.
  [[nodiscard]] const std::vector<Trajectory>& stretches() const { return stretches_; }
  [[nodiscard]] MapChanges found() const { return find_changes(map_, views_, before_ ? &*before_ : nullptr, limits_); }

 private:
  void see_what_was_before(const MapField& field, const MapperConfig& config);
  [[nodiscard]] Pose2 in_grid(const Pose2& T_map_base) const;

  OccupancyMap map_;
  ChangeLimits limits_;
  ViewCounts views_;
  std::optional<ViewCounts> before_;
  std::vector<Trajectory> stretches_;
  bool is_seeing_ = false;
};

/// x_m,y_m,change,place,ended,passed: a line for each cell that changed, its centre in the map's frame.
std::string changes_table(const GridGeometry& grid, const MapChanges& changes);

}  // namespace gdtslam

// Localises scans of a log in a map. Scans do not depend on each other, so several threads share them; the result is in
// the log's order for any number of threads. One run belongs to one thread.
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

/// One scan, or every n-th.
struct ScanChoice {
  std::uint64_t first = 0;  ///< index in the log
  std::uint64_t every = 0;  ///< 0: only `first`; n: every n-th scan
};

struct LocalizeJob {
  std::string log;
  /// Live input that replaces the file with the log's name. It is not read ahead to find whether the laser nods.
  LiveLog live_log{};
  ReadOptions read;
  ScanChoice choice;
  unsigned threads = 1;  ///< CPU threads; a device takes one scan at a time
};

struct Localized {
  std::vector<LocalizedScan> scans;  ///< in the log's order
  bool nods = false;                 ///< the log has messages of a mount that tilts the laser
  std::vector<LogReader::Warning> warnings;
  bool interrupted = false;
};

/// Called with the number of scans done and the share (negative when unknown).
using LocalizeProgress = std::function<void(std::uint64_t, double)>;
/// Ends early when stop() is true, after the current scans. Throws InputError, FileError, DeviceError.
Localized localize_scans(const LocalizeJob& job, const Localizer& localizer, const LocalizeProgress& progress,
                         const std::function<bool()>& stop);

// Follows the drive of a log in a fixed map: RobotTracker over every scan. Frames: robot in the map, metres and
// radians. One drive belongs to one thread. Cost: that of the tracker, below a millisecond a scan while the robot is
// known, some tenths of a second for a search of the whole map.

struct TrackedScan {
  std::uint64_t index = 0;  ///< in the log
  double stamp_s = 0.0;
  TrackedPose pose;
};

struct TrackedDrive {
  std::vector<TrackedScan> scans;  ///< in the log's order; none for a live log, which may last days
  std::uint64_t followed = 0;      ///< scans
  std::uint64_t searches = 0;      ///< searches of the whole map
  bool nods = false;               ///< the log has messages of a mount that tilts the laser
  std::vector<LogReader::Warning> warnings;
  bool interrupted = false;
};

/// Called with each scan and its pose.
using ScanFollowed = std::function<void(const LaserScan&, const TrackedPose&)>;

/// Follows the log from scan `job.choice.first` on; ignores the rest of the choice. `cpu` must be the CPU. Ends early
/// when stop() is true. Throws InputError, also if no scan is left; FileError, DeviceError, ConfigError.
TrackedDrive track_drive(const LocalizeJob& job, const Localizer& localizer, const MapperConfig& config, Backend& cpu,
                         const LocalizeProgress& progress, const std::function<bool()>& stop,
                         const ScanFollowed& followed = {});

// Found poses as a table for `gdtslam evaluate` and other programs: a line of column names, then one line for each scan
// (docs/formats.md). Thread-safe; O(scans).

/// For programs: "poor-fit".
std::string json_name(Verdict verdict);

std::string table_text(const std::vector<LocalizedScan>& scans);
std::string table_text(const TrackedDrive& drive);

/// Counts of scans: by verdict in the order of kVerdicts, by whereabouts in the order of kWhereabouts.
std::array<std::uint64_t, kVerdicts.size()> count_verdicts(const std::vector<LocalizedScan>& scans);
std::array<std::uint64_t, kWhereabouts.size()> count_whereabouts(const TrackedDrive& drive);

// Changes in a map, found by a drive in it. Only scans with a good match count, taken while the robot was followed at
// an unambiguous place. Frame: the map's, metres. One object belongs to one thread. Cost: engine/mapping/changes.

class DriveChanges {
 public:
  /// Compares with the map of the field. For a run's map, the scans that it was made from count too. Throws InputError
  /// if the run has no map.pgm; FileError.
  DriveChanges(const MapField& field, const MapperConfig& config, const ChangeLimits& limits);

  /// The next scan of the drive. Throws InputError.
  void see(const LaserScan& scan, const TrackedPose& pose);

  [[nodiscard]] const OccupancyMap& map() const { return map_; }
  [[nodiscard]] const ChangeLimits& limits() const { return limits_; }
  [[nodiscard]] std::size_t views() const { return views_.views(); }
  /// Poses of the counted scans, in stretches without a gap.
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

/// x_m,y_m,change,place,ended,passed: a line for each changed cell, its centre in the map's frame.
std::string changes_table(const GridGeometry& grid, const MapChanges& changes);

}  // namespace gdtslam

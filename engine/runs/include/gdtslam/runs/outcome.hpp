// Result of mapping a log: the trajectory, the evidence against doubtful scans, the occupancy map, and for a nodding
// laser the counts of its points. Frame: map. Plain data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/pose3.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// Kind of the messages that measure the nod.
enum class NodKind : std::uint8_t { kNone, kEncoder, kTilt };

/// How much later odometry is stamped than its scans.
struct OdometryDelay {
  double delay_s = 0.0;  ///< negative if the scans are stamped later
  double sigma_s = 0.0;  ///< 0 if it was stated
  /// Improvement of the agreement between odometry and scans that were not used to estimate the delay, in standard
  /// deviations; compared with no delay, or with the opposite delay if that agrees better.
  double gain = 0.0;
  /// True if the delay is significant and improves the agreement with scans that were not used to estimate it.
  [[nodiscard]] bool stands_out() const { return is_long_enough() && away_s() > 5.0 * sigma_s && gain > 3.0; }
  [[nodiscard]] bool is_long_enough() const { return away_s() >= 0.02; }
  [[nodiscard]] double away_s() const { return delay_s < 0.0 ? -delay_s : delay_s; }
};

/// A fault of a log whose cause is known.
struct LogFinding {
  std::string what;        ///< the fault and its cause
  std::string evidence;    ///< how certain the cause is
  std::string options;     ///< command-line options that correct it: "--set log.max_range=7.99m"; empty: none
  bool is_mended = false;  ///< corrected by the run itself
};

/// A scan whose match is in doubt.
struct DoubtfulScan {
  std::uint64_t index = 0;  ///< index in the trajectory, from 0
  double stamp_s = 0.0;
  Doubt reason = Doubt::kNone;
  bool accepted = false;             ///< the match is used nevertheless, not the prediction
  double from_prediction_m = 0.0;    ///< distance of the match from the prediction
  double from_prediction_rad = 0.0;  ///< absolute angle between match and prediction
};

/// Counts of the points of a cloud.
struct CloudSummary {
  std::uint64_t measured = 0;  ///< points received
  std::uint64_t thinned = 0;   ///< points left after thinning
  double voxel_m = 0.0;        ///< final edge of the cubes: larger than configured if the memory was full
  std::uint64_t removed = 0;   ///< points of floor or ceiling
  std::uint64_t written = 0;
  std::string sha256;  ///< hash of the points as written
  LevelSurfaces surfaces;
};

/// Residual correction between consecutive sweeps.
struct SweepCheck {
  std::uint64_t pairs = 0;     ///< pairs of sweeps that could be compared
  std::uint64_t not_held = 0;  ///< pairs with too little overlap or structure
  std::uint64_t apart = 0;     ///< pairs with enough of both that still disagree after correction
  double mean_shift_m = 0.0;   ///< shift of the centres of the sweeps
  double max_shift_m = 0.0;
  double mean_turn_rad = 0.0;
  double max_turn_rad = 0.0;
  double drift_m = 0.0;  ///< length of the sum of all corrections
  double drift_rad = 0.0;
  double mean_rms_m = 0.0;    ///< point-to-plane distance after registration: the surfaces' own noise
  double mean_moved_m = 0.0;  ///< root mean square distance by which corrections move a sweep's points
  double wall_s = 0.0;

  /// Why linkage, mount or poses are doubtful, with advice; empty if the sweeps agree within three times the noise of
  /// their own surfaces.
  [[nodiscard]] std::string doubt() const;
};

/// Poses in space, found by the surfaces that strokes of the mount have in common.
struct SpaceOutcome {
  std::vector<Pose3> T_map_base;            ///< one for each pose of the trajectory
  std::vector<double> elevation_knots_rad;  ///< corrections of the elevation, evenly from the lowest to the highest
  double lowest_rad = 0.0;
  double highest_rad = 0.0;
  std::size_t surfels = 0;
  std::size_t pairs = 0;      ///< of surfels
  double rms_before_m = 0.0;  ///< distances of surfels from their partners' planes, with the planar path
  double rms_m = 0.0;
  Tangent3 rms_correction = Tangent3::Zero();  ///< of the planar path: x, y, z, turns about x, y, z
  Tangent3 sigma = Tangent3::Zero();           ///< half way, from the start: z and turns about x, y
  double wall_s = 0.0;
};

/// Additional results for a nodding log.
struct NoddingOutcome {
  NoddingStatistics statistics;
  std::optional<SpaceOutcome> space;  ///< with poses in space
  CloudSummary cloud;
  bool has_cloud = false;
  SweepCheck check;
};

/// CPU time of a step of a run, for all threads of the process.
struct StageTime {
  std::string name;
  double cpu_s = 0.0;
};

/// Result of mapping, before it is written.
struct MapOutcome {
  Trajectory trajectory;
  std::vector<DoubtfulScan> doubtful;
  std::vector<std::size_t> keyframes;  ///< indices into the trajectory
  std::vector<std::size_t> drives{};   ///< indices of the first scans of further drives of a merged site
  /// The mapped scan of each keyframe; empty if the laser nods.
  std::vector<LaserScan> keyframe_scans;
  std::optional<ClosedPath> closed;  ///< present if loops were closed; its poses are in the trajectory
  /// For each accepted match: the mean distance of its points to the obstacles of the map at that time.
  std::vector<double> match_distances_m;
  OccupancyMap occupancy;  ///< empty if the request has none
  /// The map is too large for one piece: tiles are made from the keyframes, and `occupancy` becomes a small map of all
  /// tiles.
  bool is_in_tiles = false;
  MapperStatistics statistics;
  std::vector<LogReader::Warning> warnings;
  std::vector<LogFinding> findings{};             ///< faults of the logs whose causes are known
  std::optional<OdometryDelay> odometry_delay{};  ///< corrected before the scans were mapped
  ExitCode broken_off = ExitCode::kDone;  ///< reason for the log's early end, if that is no error (warning_of_end)
  QueueWork adjusting;                    ///< part of the device's work for the closed path
  std::string device_loss;                ///< the error of the device that failed; empty when none did
  double log_duration_s = 0.0;            ///< between the earliest and the latest stamp
  double wall_s = 0.0;                    ///< time of the whole run with reading, and with writing for a run folder
  double cpu_s = 0.0;                     ///< CPU time of the process during the run
  double mapper_s = 0.0;                  ///< wall time inside the mapper
  // CPU time of all threads.
  double read_cpu_s = 0.0;
  double mapper_cpu_s = 0.0;  ///< inside the mapper, with the search for loops meanwhile
  double occupancy_cpu_s = 0.0;
  double loops_cpu_s = 0.0;  ///< closing the rest of the loops and adjusting the path, once the log has ended
  double cloud_cpu_s = 0.0;  ///< time for finishing a cloud once all its points are there
  bool interrupted = false;
  std::optional<NoddingOutcome> nodding;  ///< present if the laser nods
};

/// Number of scans with a pose, matched or not.
inline std::uint64_t scans_of(const MapOutcome& outcome) { return outcome.trajectory.size(); }

}  // namespace gdtslam

// Result of matching a scan: the estimate with its evidence, never a bare pose. And the counts of a mapper over all
// scans.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Why a scan is in doubt: the first three refuse the match, the last two only report one that was accepted.
enum class Doubt : std::uint8_t {
  kNone,
  kFewPoints,          ///< too few returns to match
  kLowOverlap,         ///< too few points near known obstacles
  kContradiction,      ///< too many points beside known obstacles
  kWeakEvidence,       ///< accepted, but few good matches have such overlap or contradiction
  kFarFromPrediction,  ///< accepted, but farther from the odometry than its largest plausible error
};
std::string_view to_string(Doubt doubt);

/// Why a matcher stopped.
enum class StopReason : std::uint8_t { kNotRun, kConverged, kEvaluationLimit };
std::string_view to_string(StopReason reason);

/// The pose of one scan and its evidence.
struct MatchResult {
  double stamp_s = 0.0;
  Pose2 T_map_base;               ///< the estimate; the prediction if the match was refused
  Pose2 T_map_predicted;          ///< odometry on top of the last estimate
  Pose2 T_odometry_step;          ///< by odometry since the last scan, as logged; without odometry, as predicted
  double odometry_sigma_m = 0.0;  ///< deviation of the corrected step, along each axis; 0 if nothing was estimated
  double odometry_sigma_rad = 0.0;
  double predicted_sigma_m = 0.0;  ///< deviation of the predicted step; the same, unless no odometry measured it and
                                   ///< the motion continues
  double predicted_sigma_rad = 0.0;
  double match_sigma_m = 0.0;  ///< deviation of one match, estimated beside the wheels; 0 if nothing was
  double match_sigma_rad = 0.0;
  /// True if the scan fits about as well with the predicted heading. Computed only if match and prediction are far
  /// apart.
  bool is_turn_open = true;
  double mean_cost_m = 0.0;       ///< mean capped distance of the valid points to the map's obstacles, at the estimate
  double overlap = 0.0;           ///< share of the valid points within the final gate, at the estimate
  double contradiction = 0.0;     ///< share of the points within R of known obstacles that are clearly away from them
  std::uint32_t points = 0;       ///< valid returns
  std::uint32_t evaluations = 0;  ///< poses that were costed
  StopReason stop = StopReason::kNotRun;
  Doubt doubt = Doubt::kNone;
  std::uint32_t attempts = 0;  ///< windows that were searched
  /// Proof of the last window that `certified` searched: no pose in it has a mean distance that is smaller by more than
  /// this than that of the start of the final descent.
  std::optional<double> proven_gap_m{};
  /// Covariance of the estimate within the map it was matched with. It comes from the scan and, along directions that
  /// the scan does not determine, from the preceding motion; from that motion alone if the match was refused. Set if
  /// MapperOptions::with_covariance requests it.
  std::optional<PoseCovariance> covariance{};
  bool accepted = false;  ///< the estimate is the matcher's (or the first scan's), not the prediction
  bool merged = false;    ///< a keyframe: the scan went into the map
};

/// Seconds spent in each step of figure 5.
struct StageTimes {
  double predict_s = 0.0;
  double match_s = 0.0;  ///< gate, descent and search
  double local_field_s = 0.0;
  double merge_s = 0.0;
};

/// Counts over the run so far.
struct MapperStatistics {
  std::uint64_t scans = 0;
  std::uint64_t matched = 0;           ///< pose from the matcher
  std::uint64_t doubtful = 0;          ///< fell back to the prediction, or matched with weak evidence
  std::uint64_t keyframes = 0;         ///< merged into the map
  std::uint64_t searches = 0;          ///< scans for which a window was searched
  std::uint64_t attempts = 0;          ///< windows searched, all together
  std::uint64_t restarts = 0;          ///< keyframes merged at the prediction, after a long stretch without a match
  std::uint64_t odometry_leaps = 0;    ///< odometry steps too long to be true
  std::uint64_t without_odometry = 0;  ///< scans predicted from the last motion
  std::uint64_t evaluations = 0;
  std::uint64_t dispatches = 0;   ///< kernels run, by the backend at work
  std::uint64_t submissions = 0;  ///< submissions to a device; 0 for a backend that works immediately
  QueueWork device;               ///< all that devices did for the mapper
  double path_m = 0.0;
  StageTimes stages;
};

}  // namespace gdtslam

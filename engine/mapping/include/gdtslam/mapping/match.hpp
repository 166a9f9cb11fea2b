// What matching a scan gives: the estimate with its evidence, never a bare pose.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Why a scan is in doubt: the first three refuse the match, the last two only report one that was accepted.
enum class Doubt : std::uint8_t {
  kNone,
  kFewPoints,          ///< too few returns to match
  kLowOverlap,         ///< too few points near known obstacles
  kContradiction,      ///< too many points beside known obstacles
  kWeakEvidence,       ///< accepted, but overlap or contradiction are those of few good matches
  kFarFromPrediction,  ///< accepted, but farther from the odometry than it should ever be wrong
};
std::string_view to_string(Doubt doubt);

/// Why a matcher stopped.
enum class StopReason : std::uint8_t { kNotRun, kConverged, kEvaluationLimit };
std::string_view to_string(StopReason reason);

/// How sure a pose is within a map: covariance of (x, y, theta) along the map's axes. Within a map as a whole, once the
/// rigid motion of all of it is taken out.
struct PoseCovariance {
  double xx = 0.0;  ///< m^2
  double xy = 0.0;
  double xt = 0.0;  ///< m rad
  double yy = 0.0;
  double yt = 0.0;
  double tt = 0.0;  ///< rad^2
  /// In the direction in which the position is least sure.
  [[nodiscard]] double sigma_m() const;
};

/// The pose of one scan and what speaks for it.
struct MatchResult {
  double stamp_s = 0.0;
  Pose2 T_map_base;       ///< the estimate; the prediction where the match was refused
  Pose2 T_map_predicted;  ///< odometry on top of the last estimate
  Pose2 T_odometry_step;  ///< since the last scan by odometry, as it was logged; where there was none, as predicted
  double odometry_sigma_m = 0.0;  ///< of the corrected step, along each axis; 0 where nothing was estimated
  double odometry_sigma_rad = 0.0;
  double predicted_sigma_m = 0.0;  ///< of the predicted step; the same, but where no odometry told it as motion goes on
  double predicted_sigma_rad = 0.0;
  double match_sigma_m = 0.0;  ///< of one match, as it was estimated beside the wheels; 0 where nothing was
  double match_sigma_rad = 0.0;
  /// Whether the scan fits about as well turned as it was predicted; it is asked where the two are far apart.
  bool is_turn_open = true;
  double mean_cost_m = 0.0;       ///< mean capped distance of the valid points to the map's obstacles, at the estimate
  double overlap = 0.0;           ///< share of the valid points within the final gate, at the estimate
  double contradiction = 0.0;     ///< of the points within R of known obstacles, the share clearly beside them
  std::uint32_t points = 0;       ///< valid returns
  std::uint32_t evaluations = 0;  ///< poses that were costed
  StopReason stop = StopReason::kNotRun;
  Doubt doubt = Doubt::kNone;
  std::uint32_t attempts = 0;  ///< windows that were searched
  /// Of the last window that `certified` searched: no pose there has a mean distance smaller by more than this than the
  /// one that the final descent began from.
  std::optional<double> proven_gap_m{};
  /// How sure the estimate is within the map that it was matched with: by what the scan shows of it, along what that
  /// does not show by the way that led there, and by that alone where the match was refused. Where it is asked for
  /// (MapperOptions::with_covariance) and the map lives on the CPU.
  std::optional<PoseCovariance> covariance{};
  bool accepted = false;  ///< the estimate is the matcher's (or the first scan's), not the prediction
  bool merged = false;    ///< a keyframe: the scan went into the map
};

}  // namespace gdtslam

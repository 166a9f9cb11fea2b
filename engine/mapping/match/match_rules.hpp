// Values that every matcher derives from the configuration and the prediction of a scan: the anchor cell, the prior,
// the window, the stages of a descent; and the rules of suspicion and doubt, one set for all matchers. Poses of a scan
// are in cells and radians relative to the lower left corner of the anchor cell. Not thread-safe; constant time, except
// thin() and put_thinned_first(), which are linear in the points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "descents.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_descent/pose_descent.hpp"
#include "engine/mapping/cost/objective.hpp"
#include "exhaustive.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/match.hpp"
#include "motion_estimate.hpp"

namespace gdtslam {

/// Decides when to stop wide searches. A covered or noisy laser matches nothing, and since the robot's motion is then
/// unknown, each of its scans would be searched in the widest window. Thread-safe like a number; constant time.
class Patience {
 public:
  /// After this many unmatched scans in a row, only one in kSearchedThen is searched widely. None of nine real logs has
  /// more than five in a row.
  static constexpr std::uint64_t kScans = 64;
  static constexpr std::uint64_t kSearchedThen = 8;

  /// Takes the result of a scan with enough points to be matched.
  void take(bool is_accepted) { refused_ = is_accepted ? 0 : refused_ + 1; }
  /// True if the next scan is to be searched near its prediction alone.
  [[nodiscard]] bool is_over() const { return refused_ >= kScans && refused_ % kSearchedThen != 0; }

 private:
  std::uint64_t refused_ = 0;
};

// Scans with more points than a matcher accepts. Linear.

/// Keeps every k-th point, with the least k that leaves at most `most`, which must not be 0.
inline void thin(std::vector<PointCells>& points, std::size_t most) {
  if (points.size() <= most) return;
  const std::size_t every = (points.size() + most - 1) / most;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += every) points[kept++] = points[i];
  points.resize(kept);
}

/// Evidence for a pose.
struct Evidence {
  double mean_cost_m = 0.0;
  double overlap = 0.0;
  double contradiction = 0.0;
  StopReason stop = StopReason::kNotRun;
};

/// The counts of the evidence, over all points at the nearest cell; 1/256 cell.
struct EvidenceCounts {
  std::uint64_t sum = 0;     ///< sum of the values, each capped at the wide gate
  std::uint64_t near = 0;    ///< points within the final gate
  std::uint64_t beside = 0;  ///< points farther than two final gates, near a known obstacle
  std::uint64_t known = 0;   ///< points near a known obstacle
};

/// One descent of several: the gate and the simplex of equation (8) and (4).
struct DescentStage {
  std::uint32_t gate = 0;  ///< 1/256 cell
  SimplexOptions simplex;
};

class MatchRules {
 public:
  explicit MatchRules(const MapperConfig& config);

  /// Starts a scan with this many points at the predicted pose.
  void begin(const Prediction& prediction, std::size_t points);

  [[nodiscard]] CellIndex anchor() const { return anchor_; }
  [[nodiscard]] const CellPose& predicted() const { return predicted_; }
  [[nodiscard]] const PriorParams& prior() const { return prior_; }
  [[nodiscard]] Pose2 to_metres(const CellPose& pose) const;
  /// The window around the prediction, scaled, sampled as configured. The smallest window if the prediction is
  /// hopeless.
  [[nodiscard]] SearchWindow window(double scale) const;
  /// True if a wider window may be searched.
  [[nodiscard]] bool may_search() const { return !prediction_.is_hopeless; }
  /// From the wide gate to the final one, the simplex smaller each time.
  [[nodiscard]] const std::vector<DescentStage>& stages() const { return stages_; }
  /// A descent along the slope from the prediction, for points with this mean distance from the robot, cells: its gates
  /// begin where the prediction's error ends, and narrow to the final one.
  [[nodiscard]] PoseDescent::Params descent(double range_cells) const;
  /// The same from a sample of a window.
  [[nodiscard]] PoseDescent::Params descent_from_sample() const;
  [[nodiscard]] std::uint32_t wide_gate() const { return stages_.front().gate; }
  [[nodiscard]] std::uint32_t final_gate() const { return stages_.back().gate; }
  /// Uncertainty of the prediction.
  [[nodiscard]] MotionNoise noise() const;
  /// True if the robot can be at this pose; always true if its motion is not estimated.
  [[nodiscard]] bool is_possible(const CellPose& pose) const;
  /// Distance of a pose from the prediction beyond which it is suspect.
  [[nodiscard]] double far_m() const;
  [[nodiscard]] double far_rad() const;

  [[nodiscard]] Evidence evidence(const EvidenceCounts& counts) const;
  [[nodiscard]] bool is_suspect(const Evidence& evidence) const;
  [[nodiscard]] bool is_far(const CellPose& pose) const;
  /// Judges a matched pose; the result has the prediction instead if the match is refused.
  [[nodiscard]] MatchResult judged(const CellPose& pose, const Evidence& evidence) const;

 private:
  /// Half widths around the prediction that include every possible pose.
  [[nodiscard]] MotionNoise reach() const;
  [[nodiscard]] SearchWindow make_window(double half_m, double half_rad) const;
  [[nodiscard]] std::uint32_t units(double metres) const;
  [[nodiscard]] float cells(double metres) const;
  [[nodiscard]] bool is_beyond(const CellPose& pose, double allowed_m, double allowed_rad) const;
  [[nodiscard]] Doubt find_refusal(const Evidence& evidence) const;
  [[nodiscard]] Doubt reservation_about(const CellPose& pose, const Evidence& evidence) const;

  MapperConfig config_;
  std::vector<DescentStage> stages_;
  Prediction prediction_;
  std::size_t points_ = 0;
  CellIndex anchor_{};
  CellPose predicted_;
  PriorParams prior_;
};

/// Takes every n-th point, in order, so that at most `most` are left; all points if there are no more.
inline void thin(std::span<const PointCells> points, std::size_t most, std::vector<PointCells>& thinned) {
  const std::size_t every = (points.size() + most - 1) / most;
  thinned.clear();
  for (std::size_t i = every / 2; i < points.size(); i += every) thinned.push_back(points[i]);
}

/// Orders all points, those of thin() first; returns the number of these.
inline std::size_t put_thinned_first(std::span<const PointCells> points, std::size_t most,
                                     std::vector<PointCells>& ordered) {
  thin(points, most, ordered);
  const std::size_t count = ordered.size();
  const std::size_t every = (points.size() + most - 1) / most;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % every != every / 2) ordered.push_back(points[i]);
  }
  return count;
}

}  // namespace gdtslam

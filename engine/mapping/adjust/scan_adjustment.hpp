// Adjusts scans between keyframes to the keyframes around them, which stay: such a scan becomes as good as they are.
// Frame: the keyframes'. Cost: eight pairs of scans and three iterations each; on a device three submissions a call.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/mapping/adjust/line_pairs.hpp"
#include "engine/mapping/adjust/pose_bins.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

// Moves poses along with others that were adjusted. Thread-safe.

/// Moves each of `poses` as the nearest of `before` moved to `after`, which have equal lengths; a pose farther than 4 m
/// from all of them stays. Linear in the poses and in those around each.
void carry_with_nearest(std::span<const Pose2> before, std::span<const Pose2> after, std::span<Pose2> poses);

struct ScanAdjustmentOptions {
  int iterations = 3;
  std::size_t most_keyframes = 8;
  double near_m = 3.0;
  double neighbour_bonus_m = 0.3;  ///< keyframes next in time count as this much nearer
  std::size_t next_in_time = 8;    ///< keyframes, to each side
  double alike_rad = 0.785;        ///< or for a scan without keyframe, the largest difference in heading
  double point_gate_m = 0.15;
  std::size_t points = 120;
  double stiffness = 0.3;  ///< toward the pose given, relative to the mean information of the points
};

/// A scan that is adjusted.
struct MovingScan {
  std::size_t number = 0;           ///< its own, among the scans given
  std::optional<std::size_t> last;  ///< the keyframe before it; none: those with a similar heading count as next to it
  Pose2 pose;
};

class ScanAdjustment {
 public:
  /// Keyframes and poses, one each, must outlive this.
  ScanAdjustment(std::span<const LineScan> keyframes, std::span<const Pose2> poses,
                 const ScanAdjustmentOptions& options);

  /// Adjusts the poses of `moving`, which are of `scans`. `lines` lays scans on the keyframes.
  void adjust(std::span<const LineScan> scans, std::span<MovingScan> moving, LinePairs& lines,
              WorkerPool& workers) const;

 private:
  struct Course;
  void lay(const MovingScan& moving, Course& course, std::span<LinePair> pairs) const;
  void move(MovingScan& moving, Course& course, std::span<const LinePair> pairs) const;
  [[nodiscard]] std::vector<std::size_t> keyframes_near(const Pose2& pose, std::optional<std::size_t> last) const;
  [[nodiscard]] bool is_neighbour(std::size_t keyframe, const Pose2& pose, std::optional<std::size_t> last) const;

  std::span<const LineScan> keyframes_;
  std::span<const Pose2> poses_;
  PoseBins bins_;
  ScanAdjustmentOptions options_;
};

}  // namespace gdtslam

// Every scan once more, laid on the keyframes around it, which stay: what lies between two keyframes is as good as they
// are. Frame: the keyframes'. Thread-safe. Cost: eight pairs of scans and three iterations each.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/mapping/adjust/point_to_line.hpp"
#include "engine/mapping/adjust/pose_bins.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

// Poses that follow others which were adjusted. Thread-safe.

/// Moves each of `poses` as the nearest of `before` moved to `after`, which have one entry each; farther than 4 m from
/// all of them it stays. Linear in the poses and in those around each.
void carry_with_nearest(std::span<const Pose2> before, std::span<const Pose2> after, std::span<Pose2> poses);

struct ScanAdjustmentOptions {
  int iterations = 3;
  std::size_t most_keyframes = 8;
  double near_m = 3.0;
  double neighbour_bonus_m = 0.3;  ///< keyframes next in time count as so much nearer
  std::size_t next_in_time = 8;    ///< keyframes, to each side
  double alike_rad = 0.785;        ///< or of a scan that hangs on none, what two headings differ by at most
  double point_gate_m = 0.15;
  std::size_t points = 120;
  double stiffness = 0.3;  ///< toward the pose given, relative to what the points tell in the mean
};

class ScanAdjustment {
 public:
  /// Both must outlive this, one a keyframe.
  ScanAdjustment(std::span<const KeptScan> keyframes, std::span<const Pose2> poses,
                 const ScanAdjustmentOptions& options);

  /// The pose of a scan that was taken after keyframe `last` and before the next; the keyframe itself does not count
  /// where the scan is one. Where there is no such keyframe those that look the same way count as next to it.
  [[nodiscard]] Pose2 adjusted(const KeptScan& scan, const Pose2& pose, std::optional<std::size_t> last,
                               bool is_keyframe) const;

 private:
  [[nodiscard]] std::vector<std::size_t> keyframes_near(const Pose2& pose, std::optional<std::size_t> last,
                                                        bool is_keyframe) const;
  [[nodiscard]] bool is_neighbour(std::size_t keyframe, const Pose2& pose, std::optional<std::size_t> last) const;

  std::span<const KeptScan> keyframes_;
  std::span<const Pose2> poses_;
  PoseBins bins_;
  ScanAdjustmentOptions options_;
};

}  // namespace gdtslam

// The direction of most walls in a map, from the surfaces that its scans saw. Walls across count as much as walls
// along: directions are taken modulo a quarter turn. Frame: map. Thread-safe; linear in the points, the same bits
// everywhere.
#pragma once

#include <optional>
#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

struct WallDirection {
  double angle_rad = 0.0;  ///< angle of the walls from the x axis, in [-pi/4, pi/4)
  double share = 0.0;      ///< share of the surface, in metres seen, within 2 degrees, modulo a quarter turn
};

/// Takes the surfaces of one scan after another. One object belongs to one thread.
class WallDirectionFinder {
 public:
  WallDirectionFinder();
  /// Takes the returns of a scan in beam order, in the robot's frame, and the robot's pose. Each point on a surface
  /// (keep_scan) counts by its distance, to which the length of wall under its beam is proportional.
  void add(const std::vector<Point2>& points_base_m, const Pose2& T_map_base);
  /// The peak of the histogram (bins of 0.1 degree, smoothed over 2 degrees), refined by the weighted mean of the
  /// surfaces around it. Empty if no direction stands out: the best has less than 15 % of the surface within 2 degrees;
  /// by chance it would have 4.4 %.
  [[nodiscard]] std::optional<WallDirection> direction() const;

 private:
  std::vector<double> weight_;  // weight of each bin of a quarter turn
  std::vector<double> sum_;     // sum of the offsets from the bin's middle, by weight
};

}  // namespace gdtslam

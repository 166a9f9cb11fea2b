// Poses of the robot between the known ones, equation (13): by time, never by index. Frame: map. One path belongs to
// one thread; the functions are thread-safe.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "sweep_assembler.hpp"

namespace gdtslam {

/// A fix with the odometry at its time.
struct PoseFix {
  double stamp_s = 0.0;
  Pose2 T_map_base;
  Pose2 T_odom_base;
};

/// share 0 gives `from`, 1 gives `to`; only kOdometry reads T_odom_base (at the requested time).
Pose2 interpolate(PoseInterpolation how, const PoseFix& from, const PoseFix& to, double share,
                  const Pose2& T_odom_base);

/// The pose by odometry alone, relative to a fix before or after it.
PoseFix by_odometry(const PoseFix& fix, double stamp_s, const Pose2& T_odom_base);
/// Fills in the poses of nodes between two fixes, (13). linear and geodesic go by time. odometry distributes the error
/// at the second fix in proportion to the odometry's variance up to each node: turning counts most, then distance, then
/// time.
void place_between(PoseInterpolation how, const PoseFix& from, const PoseFix& to, std::span<PoseFix> nodes);

/// Moves evenly along a circle from each node to the next.
class PosePath {
 public:
  void append(const PoseFix& node) { nodes_.push_back(node); }
  [[nodiscard]] const PoseFix& node(std::size_t index) const { return nodes_[index]; }
  [[nodiscard]] const PoseFix& last() const { return nodes_.back(); }
  /// Poses over the time of a scan whose stamp is that of node `index`: at the phases' begin and end, and at the node
  /// if it lies between them.
  [[nodiscard]] std::vector<PoseKnot> knots(std::size_t index, std::span<const PhaseKnot> phases,
                                            const Pose2& T_map_fix) const;

 private:
  /// Pose `offset_s` after the stamp of a node; beyond the ends of the path the adjacent motion continues.
  [[nodiscard]] Pose2 at(std::size_t index, double offset_s) const;

  std::vector<PoseFix> nodes_;
};

}  // namespace gdtslam

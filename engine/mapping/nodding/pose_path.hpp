// Where the robot was between the poses that are known: evenly along a circle from one to the next. Frame: map. One
// path belongs to one thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pose_interpolation.hpp"
#include "sweep_assembler.hpp"

namespace gdtslam {

/// The pose that odometry alone tells, seen from a fix before or after it.
PoseFix by_odometry(const PoseFix& fix, double stamp_s, const Pose2& T_odom_base);
/// Fills in the poses of nodes between two fixes, (13). linear and geodesic go by time. odometry gives each node that
/// share of what is left over which its part of the way has of the odometry's variance: turning counts most, then
/// distance, then time.
void place_between(PoseInterpolation how, const PoseFix& from, const PoseFix& to, std::span<PoseFix> nodes);

/// The same along one circle, each node as far along it as its part of the odometry's way: where two poses are close
/// and both better known than the odometry between them.
void place_along(const PoseFix& from, const PoseFix& to, std::span<PoseFix> nodes);

class PosePath {
 public:
  void append(const PoseFix& node) { nodes_.push_back(node); }
  [[nodiscard]] const PoseFix& node(std::size_t index) const { return nodes_[index]; }
  [[nodiscard]] const PoseFix& last() const { return nodes_.back(); }
  /// Poses over the time of a scan whose stamp is that of node `index`: at the phases' begin and end, and at the node
  /// where it lies between them.
  [[nodiscard]] std::vector<PoseKnot> knots(std::size_t index, std::span<const PhaseKnot> phases,
                                            const Pose2& T_map_fix) const;

 private:
  /// `offset_s` after the stamp of a node; beyond the ends of the path the motion next to it goes on.
  [[nodiscard]] Pose2 at(std::size_t index, double offset_s) const;

  std::vector<PoseFix> nodes_;
};

}  // namespace gdtslam

// Where the robot was between the poses that are known: evenly along a circle from one to the next. Frame: map. One
// path belongs to one thread.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/pose_interpolation.hpp"
#include "gdtslam/mapping/sweep_assembler.hpp"

namespace gdtslam {

/// The pose of a scan that odometry alone tells, seen from a fix before or after it; the fix's where there is none.
PoseFix by_odometry(const PoseFix& fix, const ScanRecord& record);
/// The pose at a time between two fixes, (13). Without odometry kOdometry falls back to kGeodesic.
PoseFix between_fixes(PoseInterpolation how, const PoseFix& from, const PoseFix& to, double stamp_s,
                      const std::optional<Pose2>& T_odom_base);

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

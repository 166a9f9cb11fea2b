// Keyframes along a stretch of the path as one: all their points in the frame of the middle one, the space that their
// beams crossed, and, for a group that others are searched in, a distance field. Not thread-safe while it is made.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/loops/free_space.hpp"
#include "engine/mapping/loops/group_doubt.hpp"
#include "engine/mapping/surface/kept_scans.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

/// Input of a group: the keyframes of a run and their poses.
struct KeyframePath {
  ScansOfPath scans;
  std::span<const Pose2> poses;
  std::span<const double> path_m;       ///< travelled until each
  std::span<const StepDoubt> doubts{};  ///< doubt of each keyframe; empty: they lie exactly at `poses`
};

/// Whether a group of them would have a point: keyframes of an edited run may have lost all their returns. What has
/// none is neither looked for nor in.
bool have_points(const KeyframePath& keyframes, std::size_t middle, double half_m);

class ScanGroup {
 public:
  /// The keyframes within half_m of path of the one in the middle, thinned to a point a cell of `spacing_m`.
  ScanGroup(const KeyframePath& keyframes, std::size_t middle, double half_m, double spacing_m);

  /// Whether the keyframes lie otherwise relative to each other than when the group was made, by more than what a
  /// distance field of loops tells apart.
  [[nodiscard]] bool is_bent(std::span<const Pose2> poses) const;
  [[nodiscard]] const std::vector<Point2>& points() const { return points_; }
  [[nodiscard]] const FreeSpace& space() const { return *space_; }
  [[nodiscard]] const GroupDoubt& doubt() const { return *doubt_; }
  [[nodiscard]] std::size_t keyframes() const { return in_middle_.size(); }

 private:
  std::size_t middle_;
  std::size_t first_ = 0;
  std::vector<Pose2> in_middle_;  // the keyframes from the first on
  std::vector<Point2> points_;
  std::unique_ptr<FreeSpace> space_;
  std::optional<GroupDoubt> doubt_;
};

}  // namespace gdtslam

// Groups the keyframes of a stretch of the path: all points in the frame of the middle one, the space that their beams
// crossed, and, for a group that others are searched in, a distance field. Not thread-safe while it is made.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/loops/free_space.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

/// Keeps the first point of each cell, in the order given. Not thread-safe; constant time each.
class PointThinner {
 public:
  explicit PointThinner(double spacing_m) : spacing_m_(spacing_m) {}
  bool is_first(const Point2& point) {
    const auto x = static_cast<std::int32_t>(std::floor(point.x() / spacing_m_));
    const auto y = static_cast<std::int32_t>(std::floor(point.y() / spacing_m_));
    return seen_
        .insert((static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) | static_cast<std::uint32_t>(y))
        .second;
  }

 private:
  double spacing_m_;
  std::unordered_set<std::uint64_t> seen_;  // never iterated over
};

// Errors of the keyframes' poses within a group: a wall that the middle keyframe did not see itself is as uncertain as
// the path between the two. Frame: that of the middle. Thread-safe to read; linear in the keyframes.

/// Covariances of a keyframe's pose, as the front end states them: tangents at the keyframe.
struct StepDoubt {
  Matrix3 step;    ///< covariance of the step from the one before; these add up
  Matrix3 unseen;  ///< covariance of the keyframe itself along unseen directions; these do not add up
};

class GroupDoubt {
 public:
  /// Consecutive keyframes at `in_middle`, in the frame of the keyframe `middle`. Without `doubts` these poses count as
  /// exact.
  GroupDoubt(std::span<const StepDoubt> doubts, std::span<const Pose2> in_middle, std::size_t middle);

  /// Covariance of a pose that is the least squares over the points of all keyframes, as far as it comes from errors of
  /// their poses: first-order propagation, each step moving all later keyframes. `shapes`: the sum of J^T J over each
  /// keyframe's points, for motions in the middle's frame.
  [[nodiscard]] Matrix3 of_pose(std::span<const Matrix3> shapes) const;

 private:
  std::size_t middle_;
  std::vector<Matrix3> steps_;  // covariance of the step to each keyframe, in the frame of the middle
  std::vector<Matrix3> unseen_;
};

/// Input of a group: the keyframes of a run and their poses.
struct KeyframePath {
  ScansOfPath scans;
  std::span<const Pose2> poses;
  std::span<const double> path_m;       ///< path length up to each
  std::span<const StepDoubt> doubts{};  ///< doubt of each keyframe; empty: they lie exactly at `poses`
};

/// True if a group would have a point. Keyframes of an edited run may have lost all returns; such a group takes no part
/// in any search.
bool have_points(const KeyframePath& keyframes, std::size_t middle, double half_m);

class ScanGroup {
 public:
  /// Takes the keyframes within half_m of path of the middle one, one of those that lie beside each other, thinned to a
  /// point a cell of `spacing_m`.
  ScanGroup(const KeyframePath& keyframes, std::size_t middle, double half_m, double spacing_m);

  /// True if the keyframes have moved relative to each other since the group was made, by more than the distance field
  /// of loops resolves.
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

// The distance field of a group of points, for the certified search. Frame: the points'. Cost: some milliseconds for
// each thousand square metres.

/// Distance field with cells of resolution_m and distances up to the map's default limit. The mutex allows one field at
/// a time on the backend. Throws InputError if the points extend over more than 32767 cells, ConfigError if the limit
/// is less than one cell or more than 255.
FieldCopy make_distance_field(const std::vector<Point2>& points_m, double resolution_m, Backend& backend,
                              std::mutex& backend_mutex);

/// Every nth point, at most `most`.
std::vector<Point2> every_nth(const std::vector<Point2>& points, std::size_t most);

}  // namespace gdtslam

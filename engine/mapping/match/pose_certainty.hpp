// How sure a matched pose is by what its scan shows of the map: the distances of its points from the map's obstacles
// have gradients, and along a direction in which none of them changes the scan says nothing. Frames: pose of the robot
// in the map; tangent (x, y, theta) on the right, metres and radians. Thread-safe. Cost: sixteen cells a point.
#pragma once

#include <optional>
#include <span>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/match/motion_estimate.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

/// Covariance of the pose from the points alone. The information is the sum of J^T J over those within `gate_m` of an
/// obstacle, J the gradient of their distance, over its variance [Censi2007, section III]; points in one cell of the
/// map count as one, for they share its error. The variance is that of the distances, at least that of rounding to
/// cells. The rounding itself is added once more, as all cells of a wall are rounded alike. Empty if no point is near
/// an obstacle. The map lives on the CPU.
std::optional<Matrix3> covariance_by_scan(const GlobalField& map, std::span<const PointCells> points,
                                          const Pose2& T_map_base, double gate_m);

/// Covariance of one pose from two sources whose errors may be correlated in any way, as those of scans in one map are:
/// covariance intersection [Julier1997], with the weights that leave the smallest determinant.
Matrix3 intersect_covariances(const Matrix3& a, const Matrix3& b);

/// How sure the robot's pose is within the map that its scans are matched with, from scan to scan: by what the scan
/// shows where it was matched, along what it does not show by the way that led there, and by that alone where it was
/// not. Belongs to one thread.
class PoseCertainty {
 public:
  /// Starts at a pose that is the map's origin.
  PoseCertainty();
  /// Starts at a pose with that covariance; tangent (x, y, theta).
  explicit PoseCertainty(const Matrix3& covariance) : covariance_(covariance) {}
  /// From the last pose to the one that was predicted, with what the wheels may get wrong, `wheels`; a motion that only
  /// goes on may be wrong altogether.
  void carry(const Pose2& T_map_last, const Prediction& prediction, const MotionNoise& wheels);
  /// With what a scan shows that was matched at this pose.
  void weigh(const GlobalField& map, std::span<const PointCells> points, const Pose2& T_map_base, double gate_m);
  [[nodiscard]] const Matrix3& covariance() const { return covariance_; }
  /// Along the map's axes.
  [[nodiscard]] PoseCovariance in_map(double theta_rad) const;

 private:
  Matrix3 covariance_;  // covariance of the tangent at the last pose
};

}  // namespace gdtslam

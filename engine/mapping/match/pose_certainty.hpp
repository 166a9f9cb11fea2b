// How sure a matched pose is by what its scan shows of the map: the distances of its points from the map's obstacles
// have gradients, and along a direction in which none of them changes the scan says nothing. Frames: pose of the robot
// in the map; tangent (x, y, theta) on the right, metres and radians. Thread-safe. Cost: sixteen cells a point.
#pragma once

#include <optional>
#include <span>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/match/motion_model.hpp"
#include "gdtslam/compute/kernel_options.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

/// What the points say of the pose by themselves: the sum of J^T J over those within `gate_m` of an obstacle, J the
/// gradient of their distance, over its variance [Censi2007, section III]; points in one cell of the map count as one,
/// for they share its error. The variance is that of the distances, and that of rounding to cells at least. On top of
/// what follows from that comes the rounding itself once more, as all cells of a wall are rounded alike. Nothing where
/// no point is near an obstacle. The map lives on the CPU.
std::optional<Matrix3> covariance_by_scan(const GlobalField& map, std::span<const PointCells> points,
                                          const Pose2& T_map_base, double gate_m);

/// Of one pose by two sources whose errors may go together in any way, as those of scans in one map do: covariance
/// intersection [Julier1997], with the weights that leave the smallest determinant.
Matrix3 intersection_of(const Matrix3& a, const Matrix3& b);

/// How sure the robot's pose is within the map that its scans are matched with, from scan to scan: by what the scan
/// shows where it was matched, along what it does not show by the way that led there, and by that alone where it was
/// not. Belongs to one thread.
class PoseCertainty {
 public:
  /// Of a pose that is the map's origin.
  PoseCertainty();
  /// Of a pose that is known like that; tangent (x, y, theta).
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
  Matrix3 covariance_;  // of the tangent at the last pose
};

}  // namespace gdtslam

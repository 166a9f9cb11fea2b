// Uncertainty of a matched pose from the scan and the map: the distances of the scan's points from the map's obstacles
// have gradients; in a direction along which no distance changes, the scan has no information. Frames: pose of the
// robot in the map; tangent (x, y, theta) on the right, metres and radians. Thread-safe. Cost: sixteen cells a point.
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
/// map count as one, because they share its error. The variance is that of the distances, at least that of rounding to
/// cells. The rounding itself is added once more, because all cells of a wall are rounded alike. Empty if no point is
/// near an obstacle. The map lives on the CPU.
std::optional<Matrix3> covariance_by_scan(const GlobalField& map, std::span<const PointCells> points,
                                          const Pose2& T_map_base, double gate_m);

/// Covariance of one pose from two sources whose errors may be correlated in any way, such as scans in one map:
/// covariance intersection [Julier1997], with the weights that give the smallest determinant.
Matrix3 intersect_covariances(const Matrix3& a, const Matrix3& b);

/// Uncertainty of the robot's pose within the map, from scan to scan. A matched scan determines the directions that it
/// shows; the preceding motion determines the others, and all of them without a match. Belongs to one thread.
class PoseCertainty {
 public:
  /// Starts at a pose that is the map's origin.
  PoseCertainty();
  /// Starts at a pose with that covariance; tangent (x, y, theta).
  explicit PoseCertainty(const Matrix3& covariance) : covariance_(covariance) {}
  /// Moves the covariance from the last pose to the predicted one and adds the wheels' noise, `wheels`. Without
  /// odometry the noise is as large as the predicted motion itself.
  void carry(const Pose2& T_map_last, const Prediction& prediction, const MotionNoise& wheels);
  /// Adds the information of a scan matched at this pose.
  void weigh(const GlobalField& map, std::span<const PointCells> points, const Pose2& T_map_base, double gate_m);
  [[nodiscard]] const Matrix3& covariance() const { return covariance_; }
  /// The covariance along the map's axes.
  [[nodiscard]] PoseCovariance in_map(double theta_rad) const;

 private:
  Matrix3 covariance_;  // covariance of the tangent at the last pose
};

}  // namespace gdtslam

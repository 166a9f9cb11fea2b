// How sure a matched pose is by what its scan shows of the map: the distances of its points from the map's obstacles
// have gradients, and along a direction in which none of them changes the scan says nothing. Frames: pose of the robot
// in the map; tangent (x, y, theta) on the right, metres and radians. Thread-safe. Cost: sixteen cells a point.
#pragma once

#include <optional>
#include <span>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/compute/kernel_options.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/global_field.hpp"

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

/// Along the map's axes what is along the robot's.
Matrix3 in_map_axes(const Matrix3& covariance, double theta_rad);

}  // namespace gdtslam

// How well a scan can tell where the robot stands, from the scan alone: along a bare corridor it cannot. Frame: robot,
// cells; the result does not depend on the frame. Constant memory; O(points). Thread-safe.
#pragma once

#include <array>
#include <span>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"

namespace gdtslam {

/// The normal equations of sliding and turning a scan along its own lines (point to line [Censi2008]): xx, xy, xt, yy,
/// yt, tt, in cells and radians. Each point's line is the main axis of its neighbours within 25 cm among the eight
/// beams on either side; a point with fewer than two such neighbours does not count. Points in the order of the beams.
std::array<double, 6> line_information(std::span<const PointCells> points, double resolution_m);

/// The ratio of the smaller to the larger eigenvalue of such normal equations over x and y with the heading left free
/// (Schur complement). 0 in a corridor without an end, 1 where all directions are alike.
double constraint_strength(const std::array<double, 6>& information);

/// Below this a scan counts as weak along a corridor: less than one point in twenty lies across.
inline constexpr double kWeakHold = 0.05;

}  // namespace gdtslam

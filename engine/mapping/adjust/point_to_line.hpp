// Point-to-line scan matching [Censi2008]: the normal equations that align the surface points of one scan with those of
// another. Each point is paired with the nearest point in about the same direction. Thread-safe. Cost of each point
// taken: a search of log n and at most two dozen candidates.
#pragma once

#include <cstddef>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Which points count, and how much.
struct LineGate {
  double most_m = 0.15;     ///< gate: points farther from their line do not count; it also scales the robust kernel
  std::size_t points = 90;  ///< approximate number of points taken from the moving scan
};

/// Normal equations for a motion of the moving scan: right perturbation, in the frame of that scan.
struct LineEquations {
  Matrix3 information;  ///< per square metre of point noise
  Tangent2 gradient{};
  double weight = 0.0;  ///< sum of the weights of the points that count
  double cost_m2 = 0.0;
};

/// Builds the equations from the points of `moving` at T_fixed_moving and the lines of `fixed`.
LineEquations line_equations(const KeptScan& fixed, const KeptScan& moving, const Pose2& T_fixed_moving,
                             const LineGate& gate);

}  // namespace gdtslam

// Scans laid on each other, points on lines [Censi2008]: the normal equations of one scan's surface points against
// those of another, each with the nearest in its direction. Thread-safe. Cost: a search of log n and at most two dozen
// points for each point taken.
#pragma once

#include <cstddef>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Which points count, and how much.
struct LineGate {
  double most_m = 0.15;     ///< farther from its line no point counts; the robust kernel is a part of it wide
  std::size_t points = 90;  ///< about how many are taken of the moving scan
};

/// For a motion of the moving scan, tangent on the right, in its own frame.
struct LineEquations {
  Matrix3 information;  ///< per square metre of point noise
  Tangent2 gradient{};
  double weight = 0.0;  ///< points that count, each by its weight
  double cost_m2 = 0.0;
};

/// `moving` at T_fixed_moving against the lines of `fixed`.
LineEquations line_equations(const KeptScan& fixed, const KeptScan& moving, const Pose2& T_fixed_moving,
                             const LineGate& gate);

}  // namespace gdtslam

// The single errors behind the figures of `gdtslam evaluate`, for plots: of each pose against a reference trajectory,
// or of each verified relation [Kuemmerle2009]. Thread-safe; O(n log n).
#pragma once

#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {

/// One error and when it was made (of a relation: its second stamp).
struct TrajectoryError {
  double stamp_s = 0.0;
  double position_m = 0.0;
  double angle_deg = 0.0;
};

/// After the same rigid alignment as evaluate_reference(), in the order of the estimate. Throws InputError when fewer
/// than two stamps match.
std::vector<TrajectoryError> errors_against(const Trajectory& estimate, const Trajectory& reference);
/// In the order of the relations, those without their stamps in the trajectory left out.
std::vector<TrajectoryError> errors_against(const Trajectory& estimate, const std::vector<Relation>& relations);

}  // namespace gdtslam

// Downhill simplex of Nelder and Mead [Nelder1965] over (x, y, theta), the paper's optimizer ("linear simplex"). Adds,
// multiplies and comparisons in float32 only, so every host gives the same bits. The walk itself is the kernel
// pose_simplex. Thread-safe on objectives of their own.
#pragma once

#include <cstdint>

#include "engine/mapping/cost/objective.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

struct SimplexOptions {
  float step_cells = 2.0F;   ///< edge of the first simplex along x and y
  float step_rad = 0.03F;    ///< and along theta
  float stop_cells = 0.01F;  ///< stops when the simplex is smaller than this in x and y ...
  float stop_rad = 0.0002F;  ///< ... and than this in theta
  std::uint32_t max_evaluations = 200;
};

LocalMinimum minimise_simplex(Objective& objective, const CellPose& start, const SimplexOptions& options);

}  // namespace gdtslam

// The matcher `gauss-newton`, and the end of `simplex-newton`: iteratively reweighted least squares on the bilinear
// field with a robust cost [Huber1964], damped after [Levenberg1944, Marquardt1963]. Ours, not the paper's: it follows
// the field's slope, so it needs a tenth of a simplex's evaluations. Additions in a fixed order, so every host gives
// the same bits. Thread-safe on objectives of their own.
#pragma once

#include <cstdint>

#include "engine/mapping/cost/objective.hpp"

namespace gdtslam {

struct GaussNewtonOptions {
  float scale_cells = 1.0F;  ///< distances below count as squares, above as they are
  float stop_cells = 0.01F;  ///< stops when a step is smaller than this in x and y ...
  float stop_rad = 0.0002F;  ///< ... and than this in theta
  std::uint32_t max_evaluations = 50;
};

LocalMinimum minimise_gauss_newton(Objective& objective, const CellPose& start, const GaussNewtonOptions& options);

}  // namespace gdtslam

// Minimisers of the cost (4) near a start pose. The paper's simplex and the descent along the field's slope run on this
// thread; the backend evaluates the generations and complexes of the other optimizers as batches. All operations are
// correctly rounded and have a fixed order, so every host gives the same bits. Thread-safe on separate objectives.
#pragma once

#include <cstdint>

#include "engine/mapping/cost/objective.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

/// The box around the start, and the size at which a population counts as converged.
struct PoseBox {
  float half_cells = 8.0F;
  float half_rad = 0.12F;
  float stop_cells = 0.01F;
  float stop_rad = 0.0002F;
};

/// The paper's other optimizers as matchers, `pso`, `sce` and `simpsa`: `kind` is kPso, kSce or kSimpsa
/// (optimize/minimise.hpp has the methods). The seed is the same for every scan, so a scan's result depends on the scan
/// and the map alone. Never worse than the start.
LocalMinimum minimise_in_box(Objective& objective, const CellPose& start, const PoseBox& box, MatcherKind kind,
                             const OptimizerConfig& options);

/// Downhill simplex of Nelder and Mead [Nelder1965] over (x, y, theta), the paper's optimizer ("linear simplex"), with
/// adds, multiplies and comparisons in float32 only. The walk itself is the kernel pose_simplex.
struct SimplexOptions {
  float step_cells = 2.0F;   ///< edge of the first simplex along x and y
  float step_rad = 0.03F;    ///< and along theta
  float stop_cells = 0.01F;  ///< stops when the simplex is smaller than this in x and y ...
  float stop_rad = 0.0002F;  ///< ... and than this in theta
  std::uint32_t max_evaluations = 200;
};

/// Translates the stop codes of the walking kernels.
StopReason stop_reason(std::uint32_t stop);
LocalMinimum minimise_simplex(Objective& objective, const CellPose& start, const SimplexOptions& options);

/// The matcher `gauss-newton`: iteratively reweighted least squares on the bilinear field with a redescending cost, its
/// width narrowing. Ours, not the paper's: it follows the field's slope. The kernel pose_descent; the cost of the
/// result is (4) at its end.
LocalMinimum minimise_along_slope(Objective& objective, const CellPose& start, const PoseDescent::Params& descent);

}  // namespace gdtslam

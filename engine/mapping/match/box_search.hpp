// The paper's other optimizers as matchers, `pso`, `sce` and `simpsa`: each looks for the least cost (4) in a box of
// poses around a start (optimize/minimise.hpp has the methods). What can be costed at once, a generation of a swarm, a
// step of every complex, goes to the backend as one batch. The same seed for every scan, so a scan's result depends on
// the scan and the map alone. Thread-safe on objectives of their own.
#pragma once

#include <cstdint>

#include "engine/mapping/cost/objective.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

/// The box around the start, and how small a population has to be to have converged.
struct PoseBox {
  float half_cells = 8.0F;
  float half_rad = 0.12F;
  float stop_cells = 0.01F;
  float stop_rad = 0.0002F;
};

/// `kind` is kPso, kSce or kSimpsa. Never worse than the start.
LocalMinimum minimise_in_box(Objective& objective, const CellPose& start, const PoseBox& box, MatcherKind kind,
                             const OptimizerConfig& options);

}  // namespace gdtslam

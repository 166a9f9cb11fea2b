#include "simplex.hpp"

namespace gdtslam {
namespace {

StopReason reason_of(std::uint32_t stop) {
  return stop == 1 ? StopReason::kConverged : stop == 2 ? StopReason::kEvaluationLimit : StopReason::kNotRun;
}

}  // namespace

LocalMinimum minimise_simplex(Objective& objective, const CellPose& start, const SimplexOptions& options) {
  const PolishedPose found = objective.descend(start, {.cost = objective.cost_params(),
                                                       .prior = objective.prior_params(),
                                                       .step_cells = options.step_cells,
                                                       .step_rad = options.step_rad,
                                                       .stop_cells = options.stop_cells,
                                                       .stop_rad = options.stop_rad,
                                                       .max_evaluations = options.max_evaluations});
  return {.pose = {found.x, found.y, found.theta},
          .cost = found.cost,
          .evaluations = found.evaluations,
          .stop = reason_of(found.stop)};
}

}  // namespace gdtslam

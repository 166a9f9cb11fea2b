// Corrects a planar path in space by the surfaces that strokes of the mount have in common, as [Bosse2012] does:
// surfels of different strokes are brought into one plane by least squares in which outliers count less and less.
// Priors: the planar path is nearly right, the height follows pitch and way, and the tilt changes as little as the
// strokes allow. How much it changes is estimated on the way, so on a flat floor the path stays planar. Walls and
// floors level the whole. Frame: map. The same bits on every host. Cost: ten iterations, linear in the strokes
// (docs/mapping.md).
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "path_correction.hpp"
#include "surfels.hpp"

namespace gdtslam {

struct StrokeAdjustmentOptions {
  // Standard deviations of corrections, each by itself...
  double place_m = 0.02;
  double heading_rad = 0.01;
  double height_m = 1.0;
  double tilt_rad = 0.2;
  double elevation_rad = 0.017;  ///< until it is estimated
  // ...and of their changes in a second.
  double place_step_m = 0.01;
  double heading_step_rad = 0.01;
  double height_step_m = 0.006;  ///< besides what pitch and way give
  double tilt_step_rad = 0.01;   ///< until it is estimated
  // Distances of surfels.
  double point_m = 0.01;
  double first_scale_m = 0.15;
  double last_scale_m = 0.02;
  double first_gate_m = 0.5;
  double last_gate_m = 0.15;
  double scale_narrowing = 0.8;  ///< from one iteration to the next
  double gate_narrowing = 0.875;
  double most_weight = 3.0;  ///< of the pairs of one surfel
  int iterations = 10;
};

/// Result of an adjustment. Vectors have x, y, z and the turns about x, y, z.
struct StrokeAdjustment {
  std::size_t surfels = 0;
  std::size_t pairs = 0;
  double rms_before_m = 0.0;  ///< distances of surfels from their partners' planes, within the last gate
  double rms_m = 0.0;
  Tangent3 rms_correction = Tangent3::Zero();  ///< over the knots
  /// Standard deviation of height and tilt half way, from the start; 0 for the others.
  Tangent3 sigma = Tangent3::Zero();
};

/// Adjusts the knots of `correction`; `progress` gets the share done.
StrokeAdjustment adjust_strokes(const std::vector<Surfel>& surfels, const StrokeAdjustmentOptions& options,
                                WorkerPool& workers, PathCorrection& correction,
                                const std::function<void(double)>& progress);

}  // namespace gdtslam

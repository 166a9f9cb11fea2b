// The paper's minimiser: the downhill simplex [Nelder1965] on the cost of pose_cost.hpp plus a prior. On the host only.
#pragma once

#include <cstdint>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_descent/pose_descent.hpp"

namespace gdtslam {

/// One descent from each pose, in place. The walk, in float32 without contraction: first simplex: the pose and steps
/// along x, y, theta from it, costed in that order, sorted by cost (stable). Until the largest |x_i - x_0|, |y_i - y_0|
/// is below stop_cells and the largest |theta_i - theta_0| below stop_rad, or the evaluations of this descent have
/// reached max_evaluations (tested before each move): centre = (v0 + v1 + v2) * (1/3) per coordinate, summed left to
/// right; point at f = centre + f * (v3 - centre); reflect (f -1); if its cost is below v0's expand (f -2) and keep the
/// expansion if strictly better, else the reflection; else if below v2's keep the reflection; else contract (f -1/2 if
/// the reflection is strictly better than v3, else +1/2) and keep it if strictly below the lesser of the reflection's
/// and v3's cost; else shrink v1..v3 to v0 + 1/2 * (v_i - v0), costed in that order. After each move sort (stable). The
/// cost of a pose is PoseCost's sum plus the prior's cost cut towards zero, saturating. The size is
/// tested before the limit: a small simplex has converged. Differences that are NaN do not count in it (x_i - x_0 is
/// NaN if a start is not finite; such a pose is costed like any other, and the NaN at its end is unspecified). The
/// result is v0 and its cost; evaluations grow by those of this descent.
struct PoseSimplex {
  struct Params {
    PoseCost::Params cost;
    PriorParams prior;
    float step_cells = 2.0F;   ///< edge of the first simplex along x and y
    float step_rad = 0.03F;    ///< and along theta
    float stop_cells = 0.01F;  ///< stops when the simplex is smaller than this in x and y ...
    float stop_rad = 0.0002F;  ///< ... and than this in theta
    std::uint32_t max_evaluations = 200;
  };
};

}  // namespace gdtslam

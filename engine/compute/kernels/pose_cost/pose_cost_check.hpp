// What every kernel that costs poses asks of its launch.
#pragma once

#include "engine/compute/cpu/launch.hpp"
#include "pose_cost.hpp"

namespace gdtslam {

/// Throws Error unless the parameters are within their limits; buffer 0 is the field, buffer 1 the points.
void check_cost(const PoseCost::Params& params, const LaunchCheck& check);

}  // namespace gdtslam

// The plainest program for pose_descent.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/compute/kernels/pose_descent/pose_descent.hpp"

namespace gdtslam::test {

/// One descent as PoseDescent describes it, point by point.
PolishedPose brute_slope_descent(const PoseDescent::Params& params, const std::vector<std::uint16_t>& field,
                                 const std::vector<PointCells>& points, const PolishedPose& start);

}  // namespace gdtslam::test

// The plainest program for ndt_cost.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/compute/kernels/ndt_cost/ndt_cost.hpp"

namespace gdtslam::test {

/// The score of one pose as NdtCost describes it, point by point.
std::uint32_t brute_ndt_score(const NdtCost::Params& params, const std::vector<std::uint32_t>& map,
                              const std::vector<NdtCost::Point>& points, const NdtCost::Pose& pose);

}  // namespace gdtslam::test

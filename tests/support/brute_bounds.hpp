// The plainest program for the kernel of pose_bounds.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"

namespace gdtslam::test {

/// The sums of one tile, box by box: each operation rounded to float32 by itself, integers in 64 bits with divisions
/// that round down.
std::vector<std::uint32_t> brute_bounds(const PoseBounds::Params& params, const std::vector<std::uint8_t>& field,
                                        const std::vector<BoundPoint>& points, const PoseCandidate& tile);

}  // namespace gdtslam::test

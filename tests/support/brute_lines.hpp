// The plainest program for point_to_line.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/compute/kernels/point_to_line/point_to_line.hpp"

namespace gdtslam::test {

/// The sums of one pair as PointToLine describes them, point by point.
PointToLine::Sums brute_line_sums(const PointToLine::Params& params, const std::vector<float>& values,
                                  const std::vector<std::uint16_t>& bins, const PointToLine::Pair& pair);

}  // namespace gdtslam::test

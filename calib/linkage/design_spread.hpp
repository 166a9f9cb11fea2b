// Shapes of linkages that differ, spread over all that meet a goal. Lengths in any unit. Thread-safe, deterministic.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "gdtslam/calib/four_bar.hpp"

namespace gdtslam::calib {

/// Crank, coupler, rocker and ground as shares of their sum: the same for a linkage and for a larger one of its shape.
std::array<double, 4> shares_of(const FourBar& bars);
/// Between the shares of two linkages, as the crow flies.
double distance_of_shapes(const FourBar& a, const FourBar& b);

/// Shapes nearer to each other count as one: half a percent of the sum of the bars.
inline constexpr double kSameShape = 0.005;

/// Farthest-point sampling [Gonzalez1985]: the first shape, and then at each turn the one that is farthest from all
/// that were taken, the first of equals. So no shape is farther from the taken ones than these are from each other.
/// Fewer than `count` where the others are nearer than kSameShape. O(count x shapes).
std::vector<FourBar> spread_shapes(std::span<const FourBar> shapes, std::size_t count);

}  // namespace gdtslam::calib

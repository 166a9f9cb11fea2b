// The pose that `gdtslam compare` measures errors from: the least cost (4) of a scan in a window of poses, found by
// branch and bound and polished, with the lower bound that proves it. Frame: map. Not thread-safe. Cost: some
// milliseconds to tenths of a second a scan.
#pragma once

#include <cstdint>

#include "gdtslam/mapping/certified.hpp"
#include "methods.hpp"

namespace gdtslam {

struct GlobalLimits {
  double gap_m = 5.0e-4;  ///< of the mean cost: what counts as proven; rounding leaves about 2e-4 that no proof closes
  std::uint64_t max_boxes = 200'000;  ///< of one search
};

struct GlobalSolution {
  CellPose pose;
  std::uint32_t cost = 0;
  std::uint32_t bound = 0;    ///< no pose of the window costs less
  bool is_certified = false;  ///< cost and bound are no further apart than the gap
  PoseWindow window;          ///< of the proof
  std::uint64_t boxes = 0;
  double seconds = 0.0;
};

/// Searches around the prediction, then, where the window does not hold everything within `reach` of the solution,
/// around the solution.
GlobalSolution global_solution(const CompareProblem& problem, const CellPose& predicted, const StartReach& reach,
                               const GlobalLimits& limits);

/// Cost units of a mean cost in metres for so many points.
std::uint32_t cost_of(double mean_m, std::size_t points, double resolution_m);
/// And back.
double mean_cost_m(std::uint32_t cost, std::size_t points, double resolution_m);

}  // namespace gdtslam

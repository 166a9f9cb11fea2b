#include "global.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/compute/kernels/distance_field/distance_field.hpp"

namespace gdtslam {
namespace {

// Half of the gap is the search's, so that a pose that a method finds beside the best one can be proven too.
constexpr double kSearchShare = 0.5;
// Around the prediction: how much further than the reach the solution may lie without a second search.
constexpr double kSlack_m = 0.2;
constexpr double kSlack_rad = 0.1;
constexpr int kMostSearches = 4;

bool holds_reach(const PoseWindow& window, const Pose2& pose, const StartReach& reach) {
  const PoseWindow inner{.centre = window.centre,
                         .half_x_m = window.half_x_m - reach.half_m,
                         .half_y_m = window.half_y_m - reach.half_m,
                         .half_theta_rad = window.half_theta_rad - reach.half_rad};
  return inner.holds(pose);
}

}  // namespace

std::uint32_t cost_of(double mean_m, std::size_t points, double resolution_m) {
  return static_cast<std::uint32_t>(std::floor(mean_m / resolution_m * kFieldOne * static_cast<double>(points)));
}

double mean_cost_m(std::uint32_t cost, std::size_t points, double resolution_m) {
  return static_cast<double>(cost) * resolution_m / (kFieldOne * static_cast<double>(points));
}

GlobalSolution global_solution(const CompareProblem& problem, const CellPose& predicted, const StartReach& reach,
                               const GlobalLimits& limits) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  Objective& objective = problem.objective;
  GlobalSolution best;
  best.pose = predicted;
  CertifiedOptions options{.gap_m = limits.gap_m * kSearchShare, .max_boxes = limits.max_boxes};
  PoseWindow window{.centre = objective.to_metres(predicted),
                    .half_x_m = reach.half_m + kSlack_m,
                    .half_y_m = reach.half_m + kSlack_m,
                    .half_theta_rad = reach.half_rad + kSlack_rad};
  for (int search = 0; search < kMostSearches; ++search) {
    options.starts = {objective.to_metres(best.pose)};
    const CertifiedResult found = find_pose(problem.map, objective.points(), window, options);
    const LocalMinimum end = polished(objective, objective.to_cells(found.T_map_base));
    best.pose = end.pose;
    best.cost = end.cost;
    best.bound = std::min(found.bound, end.cost);
    best.window = window;
    best.boxes += found.boxes;
    const Pose2 pose = objective.to_metres(end.pose);
    if (holds_reach(window, pose, reach)) break;
    window.centre = pose;
  }
  const std::uint32_t gap = cost_of(limits.gap_m, objective.points().size(), problem.config.map.resolution_m);
  best.is_certified = best.cost - best.bound <= gap && holds_reach(best.window, objective.to_metres(best.pose), reach);
  best.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return best;
}

}  // namespace gdtslam

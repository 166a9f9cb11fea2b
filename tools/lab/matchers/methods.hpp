// The matchers (mapping/matchers.hpp) as `gdtslam-lab compare` holds them against each other, each as one call that
// minimises the same cost (4) from a start. All are told how far off the start may be, and take from that what they
// need to know: the box of a population, the first edge of a simplex, the window of a search. Poses are in cells and
// radians relative to the objective's anchor. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/mapping/cost/objective.hpp"
#include "engine/mapping/match/matchers.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {

/// From "simplex,pso"; empty: all. The order is kept. Throws UsageError that names the option.
std::vector<MatcherKind> parse_methods(const std::string& option, const std::string& names);

/// How far from the start the least cost may lie, along x and y each, and in heading.
struct StartReach {
  double half_m = 0.0;
  double half_rad = 0.0;
};
/// The reach that the matchers of `map` assume around a prediction: four edges of their first simplex.
StartReach reach_of_prediction(const MapperConfig& config);

/// One scan's problem, ready for every method. What it refers to must outlive it.
struct CompareProblem {
  Objective& objective;  ///< points, cap and anchor set; no prior
  const CertifiedMap& map;
  const MapperConfig& config;
};

LocalMinimum minimise_by(MatcherKind method, const CompareProblem& problem, const CellPose& start,
                         const StartReach& reach);

/// The end of a valley, to a fraction of a micrometre of the mean cost: simplexes anew until none gains.
LocalMinimum polished(Objective& objective, const CellPose& start);

// The pose that errors are measured from: the least cost (4) of a scan in a window of poses, found by branch and bound
// and polished, with the lower bound that proves it. Frame: map. Some milliseconds to tenths of a second a scan.

struct GlobalLimits {
  double gap_m =
      5.0e-4;  ///< gap of the mean cost that counts as proven; rounding leaves about 2e-4 that no proof closes
  std::uint64_t max_boxes = 200'000;  ///< for one search
};

struct GlobalSolution {
  CellPose pose;
  std::uint32_t cost = 0;
  std::uint32_t bound = 0;    ///< no pose of the window costs less
  bool is_certified = false;  ///< cost and bound are no further apart than the gap
  PoseWindow window;          ///< window of the proof
  double seconds = 0.0;
};

/// Searches around the prediction, then, where the window does not hold everything within `reach` of the solution,
/// around the solution.
GlobalSolution global_solution(const CompareProblem& problem, const CellPose& predicted, const StartReach& reach,
                               const GlobalLimits& limits);

/// Cost units of a mean cost in metres for so many points.
std::uint32_t cost_from_mean(double mean_m, std::size_t points, double resolution_m);
/// And back.
double mean_cost_m(std::uint32_t cost, std::size_t points, double resolution_m);

}  // namespace gdtslam

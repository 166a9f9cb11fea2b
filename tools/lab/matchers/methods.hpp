// The matchers (mapping/matchers.hpp) that `gdtslam-lab compare` compares. Each is one call that minimises the same
// cost (4) from a start. Each gets the largest error of the start and derives its settings from it: the box of a
// population, the first edge of a simplex, the window of a search. Poses are in cells and radians relative to the
// objective's anchor. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/mapping/cost/objective.hpp"
#include "engine/mapping/match/matchers.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {

/// Parses a list such as "simplex,pso"; an empty list means all. Keeps the order. Throws a UsageError that names the
/// option.
std::vector<MatcherKind> parse_methods(const std::string& option, const std::string& names);

/// Largest distance of the optimum from the start, along x and y each, and in heading.
struct StartReach {
  double half_m = 0.0;
  double half_rad = 0.0;
};
/// The reach that the matchers of `map` assume around a prediction: four edges of their first simplex.
StartReach reach_of_prediction(const MapperConfig& config);

/// The problem of one scan, the same for every method. The referenced objects must outlive it.
struct CompareProblem {
  Objective& objective;  ///< points, cap and anchor set; no prior
  const CertifiedMap& map;
  const MapperConfig& config;
};

LocalMinimum minimise_by(MatcherKind method, const CompareProblem& problem, const CellPose& start,
                         const StartReach& reach);

/// Restarts the simplex until it no longer improves, to a fraction of a micrometre of the mean cost.
LocalMinimum polished(Objective& objective, const CellPose& start);

// The reference pose of all errors: the least cost (4) of a scan in a window of poses, found by branch and bound and
// polished, with the proven lower bound. Frame: map. Some milliseconds to tenths of a second per scan.

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

/// Searches around the prediction. If that window does not contain everything within `reach` of the solution, searches
/// around the solution as well.
GlobalSolution global_solution(const CompareProblem& problem, const CellPose& predicted, const StartReach& reach,
                               const GlobalLimits& limits);

/// Converts the mean cost of this number of points from metres to cost units.
std::uint32_t cost_from_mean(double mean_m, std::size_t points, double resolution_m);
/// Converts cost units to the mean cost in metres.
double mean_cost_m(std::uint32_t cost, std::size_t points, double resolution_m);

}  // namespace gdtslam

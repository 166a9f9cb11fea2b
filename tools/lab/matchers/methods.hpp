// The matchers (mapping/matchers.hpp) as `gdtslam compare` holds them against each other, each as one call that
// minimises the same cost (4) from a start. All are told how far off the start may be, and take from that what they
// need to know: the box of a population, the first edge of a simplex, the window of a search. Poses are in cells and
// radians relative to the objective's anchor. Not thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/mapping/cost/objective.hpp"
#include "engine/mapping/match/matchers.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {

/// From "simplex,pso"; empty: all. The order is kept. Throws UsageError that names the option.
std::vector<MatcherKind> compare_methods_of(const std::string& option, const std::string& names);

/// How far from the start the least cost may lie, along x and y each, and in heading.
struct StartReach {
  double half_m = 0.0;
  double half_rad = 0.0;
};
/// What the matchers of `map` assume around a prediction: four edges of their first simplex.
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

}  // namespace gdtslam

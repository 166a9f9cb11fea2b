#include "methods.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/io/did_you_mean.hpp"
#include "engine/mapping/match/exhaustive.hpp"
#include "engine/mapping/match/gauss_newton.hpp"
#include "engine/mapping/match/simplex.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// A proof of the matcher's own, then a simplex: what a user of it would ask for.
constexpr double kCertifiedGap_m = 0.005;

float cells_of(double length_m, const CompareProblem& problem) {
  return static_cast<float>(length_m / problem.config.map.resolution_m);
}

SimplexOptions simplex_of(const CompareProblem& problem, const StartReach& reach) {
  SimplexOptions options;
  options.step_cells = cells_of(reach.half_m, problem) / kBoxSteps;
  options.step_rad = static_cast<float>(reach.half_rad) / kBoxSteps;
  return options;
}

// Where the end is refined it is that of the robust cost, not of (4): it lies where the squares of small distances want
// it.
LocalMinimum by_walk(const MatcherInfo& matcher, const CompareProblem& problem, const CellPose& start,
                     const StartReach& reach) {
  const LocalMinimum near =
      matcher.descend(problem.objective, start, simplex_of(problem, reach), problem.config.optimizer);
  if (!matcher.is_refined) return near;
  LocalMinimum end = minimise_gauss_newton(problem.objective, near.pose, {});
  end.evaluations += near.evaluations;
  return end;
}

// The samples of `map --matcher exhaustive`, each of the best valleys to its end.
LocalMinimum by_window(const CompareProblem& problem, const CellPose& start, const StartReach& reach) {
  const SearchConfig& search = problem.config.search;
  const SearchWindow window{.centre = start,
                            .half_xy_cells = cells_of(reach.half_m, problem),
                            .half_theta_rad = static_cast<float>(reach.half_rad),
                            .step_cells = cells_of(search.step_m, problem),
                            .step_rad = static_cast<float>(search.step_rad)};
  const ExhaustiveResult found =
      search_window(problem.objective, window, static_cast<std::uint32_t>(search.starts), SimplexOptions{});
  return {found.pose, found.cost, found.evaluations, StopReason::kConverged};
}

LocalMinimum by_proof(const CompareProblem& problem, const CellPose& start, const StartReach& reach) {
  const PoseWindow window{.centre = problem.objective.to_metres(start),
                          .half_x_m = reach.half_m,
                          .half_y_m = reach.half_m,
                          .half_theta_rad = reach.half_rad};
  const CertifiedResult found = find_pose(problem.map, problem.objective.points(), window, {.gap_m = kCertifiedGap_m});
  LocalMinimum end = minimise_simplex(problem.objective, problem.objective.to_cells(found.T_map_base),
                                      {.step_cells = 0.5F, .step_rad = 0.005F});
  end.evaluations += static_cast<std::uint32_t>(found.evaluations + found.boxes);
  end.stop = found.certified() ? StopReason::kConverged : StopReason::kEvaluationLimit;
  return end;
}

}  // namespace

std::vector<MatcherKind> compare_methods_of(const std::string& option, const std::string& names) {
  std::vector<MatcherKind> chosen;
  if (names.empty()) {
    for (const MatcherInfo& matcher : matchers()) chosen.push_back(matcher.kind);
    return chosen;
  }
  const std::vector<std::string> known(matcher_names().begin(), matcher_names().end());
  for (std::size_t begin = 0; begin <= names.size();) {
    const std::size_t end = std::min(names.find(',', begin), names.size());
    const std::string name = names.substr(begin, end - begin);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      throw UsageError(fmt::format("{}: there is no method '{}'{}", option, name, did_you_mean(name, known)));
    }
    const MatcherKind method = matchers()[static_cast<std::size_t>(found - known.begin())].kind;
    if (std::find(chosen.begin(), chosen.end(), method) != chosen.end()) {
      throw UsageError(fmt::format("{}: '{}' is named twice", option, name));
    }
    chosen.push_back(method);
    begin = end + 1;
  }
  return chosen;
}

StartReach reach_of_prediction(const MapperConfig& config) {
  const SimplexOptions first;
  return {.half_m = static_cast<double>(kBoxSteps * first.step_cells) * config.map.resolution_m,
          .half_rad = static_cast<double>(kBoxSteps * first.step_rad)};
}

LocalMinimum minimise_by(MatcherKind method, const CompareProblem& problem, const CellPose& start,
                         const StartReach& reach) {
  const MatcherInfo& matcher = matcher_info(method);
  if (matcher.proves_windows) return by_proof(problem, start, reach);
  return matcher.descend != nullptr ? by_walk(matcher, problem, start, reach) : by_window(problem, start, reach);
}

LocalMinimum polished(Objective& objective, const CellPose& start) {
  constexpr int kMostRounds = 8;
  LocalMinimum best{.pose = start, .cost = objective.evaluate(start), .evaluations = 1, .stop = StopReason::kNotRun};
  SimplexOptions fine{.step_cells = 0.5F, .step_rad = 0.004F, .stop_cells = 0.001F, .stop_rad = 2.0e-5F};
  for (int round = 0; round < kMostRounds; ++round) {
    const LocalMinimum found = minimise_simplex(objective, best.pose, fine);
    best.evaluations += found.evaluations;
    best.stop = found.stop;
    if (found.cost >= best.cost) break;
    best.pose = found.pose;
    best.cost = found.cost;
    fine.step_cells *= 0.5F;
    fine.step_rad *= 0.5F;
  }
  return best;
}

}  // namespace gdtslam

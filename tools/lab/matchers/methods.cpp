#include "methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/io/did_you_mean.hpp"
#include "engine/mapping/match/descents.hpp"
#include "engine/mapping/match/exhaustive.hpp"
#include "engine/runs/drive/stopwatch.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// A proof by the matcher itself, then a simplex: typical use of it.
constexpr double kCertifiedGap_m = 0.005;

float to_cells(double length_m, const CompareProblem& problem) {
  return static_cast<float>(length_m / problem.config.map.resolution_m);
}

SimplexOptions simplex_options(const CompareProblem& problem, const StartReach& reach) {
  SimplexOptions options;
  options.step_cells = to_cells(reach.half_m, problem) / kBoxSteps;
  options.step_rad = static_cast<float>(reach.half_rad) / kBoxSteps;
  return options;
}

// The slope's descent minimises its own cost, not (4). Its first gate is as wide as the reach.
LocalMinimum by_slope(const CompareProblem& problem, const CellPose& start, const StartReach& reach) {
  PoseDescent::Params descent;
  descent.width = std::max(descent.last_width, static_cast<float>(kFieldOne) * to_cells(reach.half_m, problem));
  return minimise_along_slope(problem.objective, start, descent);
}

// The samples of `map --matcher exhaustive`; each of the best valleys is descended to its end.
LocalMinimum by_window(const CompareProblem& problem, const CellPose& start, const StartReach& reach) {
  const SearchConfig& search = problem.config.search;
  const SearchWindow window{.centre = start,
                            .half_xy_cells = to_cells(reach.half_m, problem),
                            .half_theta_rad = static_cast<float>(reach.half_rad),
                            .step_cells = to_cells(search.step_m, problem),
                            .step_rad = static_cast<float>(search.step_rad)};
  LocalMinimum best;
  std::uint32_t evaluations = window.count_xy() * window.count_xy() * window.count_theta();
  for (const CellPose& sample : best_samples(problem.objective, window, static_cast<std::uint32_t>(search.starts))) {
    const LocalMinimum found = minimise_along_slope(problem.objective, sample, {});
    evaluations += found.evaluations;
    if (best.stop == StopReason::kNotRun || found.cost < best.cost) best = found;
  }
  best.evaluations = evaluations;
  return best;
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

// Half of the gap is for the search, so that a method's pose beside the best one can be proven too.
constexpr double kSearchShare = 0.5;
// Slack around the prediction's reach: farther solutions need a second search.
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

std::vector<MatcherKind> parse_methods(const std::string& option, const std::string& names) {
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
  if (matcher.always_searches) return by_window(problem, start, reach);
  if (matcher.follows_slope) return by_slope(problem, start, reach);
  return matcher.descend(problem.objective, start, simplex_options(problem, reach), problem.config.optimizer);
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

std::uint32_t cost_from_mean(double mean_m, std::size_t points, double resolution_m) {
  return static_cast<std::uint32_t>(std::floor(mean_m / resolution_m * kFieldOne * static_cast<double>(points)));
}

double mean_cost_m(std::uint32_t cost, std::size_t points, double resolution_m) {
  return static_cast<double>(cost) * resolution_m / (kFieldOne * static_cast<double>(points));
}

GlobalSolution global_solution(const CompareProblem& problem, const CellPose& predicted, const StartReach& reach,
                               const GlobalLimits& limits) {
  Stopwatch watch;
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
    const Pose2 pose = objective.to_metres(end.pose);
    if (holds_reach(window, pose, reach)) break;
    window.centre = pose;
  }
  const std::uint32_t gap = cost_from_mean(limits.gap_m, objective.points().size(), problem.config.map.resolution_m);
  best.is_certified = best.cost - best.bound <= gap && holds_reach(best.window, objective.to_metres(best.pose), reach);
  watch.add_to(best.seconds);
  return best;
}

}  // namespace gdtslam

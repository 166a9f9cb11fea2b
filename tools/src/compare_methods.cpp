#include "compare_methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/box_search.hpp"
#include "gdtslam/mapping/exhaustive.hpp"
#include "gdtslam/mapping/gauss_newton.hpp"
#include "gdtslam/mapping/simplex.hpp"

namespace gdtslam {
namespace {

// As the mapper's matchers have it (scan_matcher.cpp): half a box in edges of the first simplex.
constexpr float kBoxSteps = 4.0F;
// A proof of the matcher's own, then a simplex: what a user of it would ask for.
constexpr double kCertifiedGap_m = 0.005;

struct MethodRow {
  CompareMethod method;
  std::string_view name;
  MatcherKind matcher;
};
constexpr std::array kMethods{
    MethodRow{CompareMethod::kSimplex, "simplex", MatcherKind::kSimplex},
    MethodRow{CompareMethod::kPso, "pso", MatcherKind::kPso},
    MethodRow{CompareMethod::kSce, "sce", MatcherKind::kSce},
    MethodRow{CompareMethod::kSimpsa, "simpsa", MatcherKind::kSimpsa},
    MethodRow{CompareMethod::kGaussNewton, "gauss-newton", MatcherKind::kGaussNewton},
    MethodRow{CompareMethod::kSimplexNewton, "simplex-newton", MatcherKind::kSimplexNewton},
    MethodRow{CompareMethod::kExhaustive, "exhaustive", MatcherKind::kExhaustive},
    MethodRow{CompareMethod::kCertified, "certified", MatcherKind::kCertified},
};
const MethodRow& row_of(CompareMethod method) { return kMethods[static_cast<std::size_t>(method)]; }

float cells_of(double length_m, const CompareProblem& problem) {
  return static_cast<float>(length_m / problem.config.map.resolution_m);
}

SimplexOptions simplex_of(const CompareProblem& problem, const StartReach& reach) {
  SimplexOptions options;
  options.step_cells = cells_of(reach.half_m, problem) / kBoxSteps;
  options.step_rad = static_cast<float>(reach.half_rad) / kBoxSteps;
  return options;
}

// The end is that of the robust cost, not of (4): it lies where the squares of small distances want it.
LocalMinimum by_simplex_newton(const CompareProblem& problem, const CellPose& start, const StartReach& reach) {
  const LocalMinimum near = minimise_simplex(problem.objective, start, simplex_of(problem, reach));
  LocalMinimum end = minimise_gauss_newton(problem.objective, near.pose, {});
  end.evaluations += near.evaluations;
  return end;
}

LocalMinimum by_population(MatcherKind kind, const CompareProblem& problem, const CellPose& start,
                           const StartReach& reach) {
  const PoseBox box{.half_cells = cells_of(reach.half_m, problem), .half_rad = static_cast<float>(reach.half_rad)};
  return minimise_in_box(problem.objective, start, box, kind, problem.config.optimizer);
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

std::string_view name_of(CompareMethod method) { return row_of(method).name; }

const std::vector<CompareMethod>& compare_methods() {
  static const std::vector<CompareMethod> all = [] {
    std::vector<CompareMethod> methods;
    methods.reserve(kMethods.size());
    for (const MethodRow& row : kMethods) methods.push_back(row.method);
    return methods;
  }();
  return all;
}

std::vector<CompareMethod> compare_methods_of(const std::string& option, const std::string& names) {
  if (names.empty()) return compare_methods();
  std::vector<std::string> known;
  for (const CompareMethod method : compare_methods()) known.emplace_back(name_of(method));
  std::vector<CompareMethod> chosen;
  for (std::size_t begin = 0; begin <= names.size();) {
    const std::size_t end = std::min(names.find(',', begin), names.size());
    const std::string name = names.substr(begin, end - begin);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      throw UsageError(fmt::format("{}: there is no method '{}'{}", option, name, did_you_mean(name, known)));
    }
    const CompareMethod method = compare_methods()[static_cast<std::size_t>(found - known.begin())];
    if (std::find(chosen.begin(), chosen.end(), method) != chosen.end()) {
      throw UsageError(fmt::format("{}: '{}' is named twice", option, name));
    }
    chosen.push_back(method);
    begin = end + 1;
  }
  return chosen;
}

MatcherKind matcher_of(CompareMethod method) { return row_of(method).matcher; }

StartReach reach_of_prediction(const MapperConfig& config) {
  const SimplexOptions first;
  return {.half_m = static_cast<double>(kBoxSteps * first.step_cells) * config.map.resolution_m,
          .half_rad = static_cast<double>(kBoxSteps * first.step_rad)};
}

LocalMinimum minimise_by(CompareMethod method, const CompareProblem& problem, const CellPose& start,
                         const StartReach& reach) {
  switch (method) {
    case CompareMethod::kSimplex:
      return minimise_simplex(problem.objective, start, simplex_of(problem, reach));
    case CompareMethod::kGaussNewton:
      return minimise_gauss_newton(problem.objective, start, {});
    case CompareMethod::kSimplexNewton:
      return by_simplex_newton(problem, start, reach);
    case CompareMethod::kExhaustive:
      return by_window(problem, start, reach);
    case CompareMethod::kCertified:
      return by_proof(problem, start, reach);
    default:
      return by_population(matcher_of(method), problem, start, reach);
  }
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

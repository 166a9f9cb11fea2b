#include <algorithm>
#include <functional>

#include "gdtslam/core/angle.hpp"
#include "run.hpp"

namespace gdtslam {
namespace {

std::vector<CompareTrial> select_trials(const CompareOutcome& outcome, std::uint32_t method, std::uint32_t level,
                                        ScanKind kind) {
  std::vector<CompareTrial> trials;
  for (const CompareTrial& trial : outcome.trials) {
    const bool is_meant = trial.method == method && trial.level == level;
    if (is_meant && scan_kind(outcome.scans[trial.scan]) == kind) trials.push_back(trial);
  }
  return trials;
}

/// Collects a member or a function of the trials.
template <class Value>
std::vector<double> collect_values(const std::vector<CompareTrial>& trials, const Value& value) {
  std::vector<double> values;
  values.reserve(trials.size());
  for (const CompareTrial& trial : trials) values.push_back(static_cast<double>(std::invoke(value, trial)));
  return values;
}

template <class Test>
Share share_that(const std::vector<CompareTrial>& trials, const Test& test) {
  return {static_cast<std::uint64_t>(std::count_if(trials.begin(), trials.end(), std::mem_fn(test))), trials.size()};
}

}  // namespace

ScanKind scan_kind(const CompareScan& scan) {
  if (!scan.is_certified) return ScanKind::kUncertain;
  return scan.is_weak() ? ScanKind::kWeak : ScanKind::kHeld;
}

std::uint64_t count_kind(const CompareOutcome& outcome, ScanKind kind) {
  return static_cast<std::uint64_t>(std::count_if(outcome.scans.begin(), outcome.scans.end(),
                                                  [kind](const CompareScan& scan) { return scan_kind(scan) == kind; }));
}

std::vector<MethodFigures> sum_figures(const CompareJob& job, const CompareOutcome& outcome, std::uint32_t level,
                                       ScanKind kind) {
  std::vector<MethodFigures> figures;
  double simplex_s = 0.0;
  for (std::uint32_t k = 0; k < job.methods.size(); ++k) {
    const std::vector<CompareTrial> trials = select_trials(outcome, k, level, kind);
    const auto summary = [&trials](const auto& value) { return summarise(collect_values(trials, value)); };
    figures.push_back({.method = std::string(to_string(job.methods[k])),
                       .distance_m = summary(&CompareTrial::distance_m),
                       .x_m = summary(&CompareTrial::x_m),
                       .y_m = summary(&CompareTrial::y_m),
                       .theta_deg = summary([](const CompareTrial& trial) { return deg_from_rad(trial.theta_rad); }),
                       .success = share_that(trials, &CompareTrial::is_success),
                       .optimal = share_that(trials, &CompareTrial::is_optimal),
                       .evaluations = summary(&CompareTrial::evaluations),
                       .seconds = summary(&CompareTrial::seconds)});
    if (job.methods[k] == MatcherKind::kSimplex) simplex_s = figures.back().seconds.mean;
  }
  for (MethodFigures& method : figures) method.time_ratio = simplex_s > 0.0 ? method.seconds.mean / simplex_s : 0.0;
  return figures;
}

std::vector<double> collect_distances(const CompareOutcome& outcome, std::uint32_t method, std::uint32_t level,
                                      ScanKind kind) {
  return collect_values(select_trials(outcome, method, level, kind), &CompareTrial::distance_m);
}

}  // namespace gdtslam

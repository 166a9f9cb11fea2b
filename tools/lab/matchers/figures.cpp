#include "figures.hpp"

#include <algorithm>
#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

struct Values {
  std::vector<double> distance_m;
  std::vector<double> x_m;
  std::vector<double> y_m;
  std::vector<double> theta_deg;
  std::vector<double> evaluations;
  std::vector<double> seconds;
  Share success;
  Share optimal;

  void add(const CompareTrial& trial) {
    distance_m.push_back(trial.distance_m);
    x_m.push_back(trial.x_m);
    y_m.push_back(trial.y_m);
    theta_deg.push_back(deg_from_rad(trial.theta_rad));
    evaluations.push_back(trial.evaluations);
    seconds.push_back(trial.seconds);
    success.count += trial.is_success() ? 1U : 0U;
    ++success.of;
    optimal.count += trial.is_optimal ? 1U : 0U;
    ++optimal.of;
  }
};

}  // namespace

ScanKind kind_of(const CompareScan& scan) {
  if (!scan.is_certified) return ScanKind::kUncertain;
  return scan.is_weak() ? ScanKind::kWeak : ScanKind::kHeld;
}

std::uint64_t count_of(const CompareOutcome& outcome, ScanKind kind) {
  return static_cast<std::uint64_t>(std::count_if(outcome.scans.begin(), outcome.scans.end(),
                                                  [kind](const CompareScan& scan) { return kind_of(scan) == kind; }));
}

std::vector<MethodFigures> figures_of(const CompareJob& job, const CompareOutcome& outcome, std::uint32_t level,
                                      ScanKind kind) {
  std::vector<Values> values(job.methods.size());
  for (const CompareTrial& trial : outcome.trials) {
    if (trial.level == level && kind_of(outcome.scans[trial.scan]) == kind) values[trial.method].add(trial);
  }
  std::vector<MethodFigures> figures;
  double simplex_s = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Values& v = values[k];
    figures.push_back({.method = std::string(to_string(job.methods[k])),
                       .distance_m = summarise(v.distance_m),
                       .x_m = summarise(v.x_m),
                       .y_m = summarise(v.y_m),
                       .theta_deg = summarise(v.theta_deg),
                       .success = v.success,
                       .optimal = v.optimal,
                       .evaluations = summarise(v.evaluations),
                       .seconds = summarise(v.seconds)});
    if (job.methods[k] == MatcherKind::kSimplex) simplex_s = figures.back().seconds.mean;
  }
  for (MethodFigures& method : figures) method.time_ratio = simplex_s > 0.0 ? method.seconds.mean / simplex_s : 0.0;
  return figures;
}

std::vector<double> distances_of(const CompareOutcome& outcome, std::uint32_t method, std::uint32_t level,
                                 ScanKind kind) {
  std::vector<double> distances;
  for (const CompareTrial& trial : outcome.trials) {
    if (trial.method == method && trial.level == level && kind_of(outcome.scans[trial.scan]) == kind) {
      distances.push_back(trial.distance_m);
    }
  }
  return distances;
}

}  // namespace gdtslam

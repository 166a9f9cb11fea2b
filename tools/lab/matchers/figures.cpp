#include <algorithm>
#include <functional>

#include "engine/runs/evaluation/errors.hpp"
#include "gdtslam/core/angle.hpp"
#include "run.hpp"

namespace gdtslam {
namespace {

std::vector<CompareTrial> select_trials(const CompareOutcome& outcome, std::uint32_t method, std::uint32_t level,
                                        ScanKind kind) {
  std::vector<CompareTrial> trials;
  for (const CompareTrial& trial : outcome.trials) {
    const bool is_meant = trial.method == method && trial.level == level;
    if (is_meant && kind_of(outcome.scans[trial.scan]) == kind) trials.push_back(trial);
  }
  return trials;
}

// Of a member or a function of them.
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

void evaluate(const MapOutcome& outcome, const CompareTruth& truth, const CompareJob& job, WholeRun& run) {
  if (truth.reference) {
    const ReferenceReport report = evaluate_reference(outcome.trajectory, *truth.reference, {});
    run.position_m = report.ate_m;
    run.heading_deg = report.ate_rotation_deg;
    return;
  }
  const RelationReport report =
      check_relations(outcome.trajectory, truth.relations, truth.relations_file, log_name(job.logs.front())).report;
  run.position_m = report.all.translation_m;
  run.heading_deg = report.all.rotation_deg;
}

/// The log mapped from end to end by a matcher.
MapOutcome map_with(MatcherKind matcher, const CompareJob& job, Backend& backend, const CompareProgress& progress,
                    const std::function<bool()>& stop) {
  MapRequest whole{.logs = job.logs,
                   .with_map = false,
                   .with_loops = false,
                   .with_pictures = false,
                   .on_failure = {.fall_back = false, .cpu = {}, .warn = {}}};
  whole.settings.mapper = job.mapper;
  whole.settings.mapper.match.matcher = matcher;
  MapOutcome outcome = MapRun(whole, backend, {job.logs, job.read, job.range}).run(progress, stop);
  if (outcome.interrupted) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
  return outcome;
}

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

std::vector<double> distances_of(const CompareOutcome& outcome, std::uint32_t method, std::uint32_t level,
                                 ScanKind kind) {
  return collect_values(select_trials(outcome, method, level, kind), &CompareTrial::distance_m);
}

std::vector<WholeRun> whole_runs(const CompareJob& job, const CompareTruth& truth, Backend& backend,
                                 const std::function<CompareProgress(const std::string&)>& progress_of,
                                 const std::function<bool()>& stop) {
  std::vector<WholeRun> runs;
  double simplex_s = 0.0;
  for (const MatcherKind method : job.methods) {
    WholeRun run;
    run.method = to_string(method);
    const MapOutcome outcome = map_with(method, job, backend, progress_of(run.method), stop);
    evaluate(outcome, truth, job, run);
    run.cpu_s = outcome.mapper_cpu_s;
    run.scans = outcome.statistics.scans;
    run.evaluations = static_cast<double>(outcome.statistics.evaluations) / static_cast<double>(run.scans);
    run.doubtful = outcome.statistics.doubtful;
    if (method == MatcherKind::kSimplex) simplex_s = run.cpu_s;
    runs.push_back(run);
  }
  for (WholeRun& run : runs) run.time_ratio = simplex_s > 0.0 ? run.cpu_s / simplex_s : 0.0;
  return runs;
}

}  // namespace gdtslam

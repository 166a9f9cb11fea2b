#include <fmt/format.h>

#include "gdtslam/core/error.hpp"
#include "run.hpp"

namespace gdtslam {
namespace {

void evaluate(const MapOutcome& outcome, const CompareTruth& truth, const CompareJob& job, WholeRun& run) {
  if (truth.reference) {
    const ReferenceReport report = evaluate_reference(outcome.trajectory, *truth.reference, {});
    run.position_m = report.ate_m;
    run.heading_deg = report.ate_rotation_deg;
    return;
  }
  const RelationReport report = evaluate_relations(outcome.trajectory, truth.relations);
  if (report.all.translation_m.count == 0) {
    throw InputError({truth.relations_file, 0},
                     fmt::format("none of its {} relations has stamps of {}; do both belong to the same log?",
                                 truth.relations.size(), log_name(job.logs.front())));
  }
  run.position_m = report.all.translation_m;
  run.heading_deg = report.all.rotation_deg;
}

}  // namespace

MapOutcome map_with(MatcherKind matcher, const CompareJob& job, Backend& backend, const CompareProgress& progress,
                    const std::function<bool()>& stop) {
  MapJob whole{.logs = job.logs,
               .read = job.read,
               .range = job.range,
               .mapper = job.mapper,
               .occupancy = {},
               .with_occupancy = false,
               .with_pictures = false,
               .on_failure = {.fall_back = false, .cpu = {}, .warn = {}}};
  whole.mapper.match.matcher = matcher;
  MapOutcome outcome = MapRun(whole, backend).run(progress, stop);
  if (outcome.interrupted) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
  return outcome;
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

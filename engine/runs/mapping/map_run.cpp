#include "map_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "engine/runs/streams/log_check.hpp"
#include "gdtslam/core/error.hpp"
#include "stopwatch.hpp"

namespace gdtslam {

OccupancyBuilder::Limits occupancy_limits(const MapperConfig& config) {
  return {.resolution_m = config.map.resolution_m,
          .min_range_m = config.scan.min_range_m,
          .max_range_m = config.scan.max_range_m,
          .max_cells = static_cast<std::uint64_t>(config.map.max_megacells) << 20U};
}

MapRun::MapRun(const MapJob& job, Backend& backend) : MapRun(job, backend, {job.logs, job.read, job.range}) {}

MapRun::MapRun(const MapJob& job, Backend& backend, ScanStream scans)
    : job_(job),
      scans_(std::move(scans)),
      mapper_(job.mapper, backend, job.on_failure),
      occupancy_(job.occupancy, occupancy_limits(job.mapper)) {}

// A signal may cut the input in the middle of a line; what the reader says of that is not the user's concern.
std::optional<ScanRecord> MapRun::next_scan(const std::function<bool()>& stop) {
  try {
    return scans_.next();
  } catch (const InputError&) {
    if (!stop()) throw;
    return std::nullopt;
  }
}

void note_match(const MatchResult& result, const Pose2& T_map_base, MapOutcome& outcome) {
  if (result.doubt != Doubt::kNone) {
    const Pose2 off = between(result.T_map_predicted, result.T_map_base);
    outcome.doubtful.push_back({outcome.trajectory.size(), result.stamp_s, result.doubt, result.accepted,
                                off.translation().norm(), std::fabs(off.theta_rad)});
  }
  if (result.accepted && result.evaluations > 0) outcome.match_distances_m.push_back(result.mean_cost_m);
  if (result.merged) outcome.keyframes.push_back(outcome.trajectory.size());
  outcome.trajectory.push_back({result.stamp_s, T_map_base});
}

void require_a_map(const MapJob& job, const MapOutcome& outcome, std::uint64_t scans_read) {
  if (outcome.statistics.keyframes > 0) return;
  const FilePosition place{log_name(job.logs.front()), 0};
  if (outcome.interrupted) {
    throw Error(ExitCode::kInterrupted, outcome.trajectory.empty()
                                            ? "interrupted before the first scan; nothing is written"
                                            : "interrupted before a scan could be mapped; nothing is written");
  }
  if (!outcome.trajectory.empty()) {
    throw InputError(place, nothing_mappable(outcome.trajectory.size(), job.mapper.scan));
  }
  if (scans_read > 0) {
    throw InputError(place, fmt::format("--skip {} leaves none of its {} scans", job.range.skip, scans_read));
  }
  throw InputError(place, "holds no laser scan to map; 'gdtslam doctor' says what is in it");
}

// The next scan is read while the device works on this one. What the reader has to complain of in it counts once this
// one is done.
MatchResult MapRun::map_scan(const ScanRecord& scan, NextScan& next, const std::function<bool()>& stop,
                             Stopwatch& watch, MapOutcome& outcome) {
  mapper_.start(scan.scan, scan.T_odom_base);
  watch.add_to(outcome.mapper_s, outcome.mapper_cpu_s);
  try {
    next.scan = next_scan(stop);
  } catch (...) {
    next.problem = std::current_exception();
  }
  watch.add_to(outcome.read_s);
  const MatchResult result = mapper_.finish();
  watch.add_to(outcome.mapper_s, outcome.mapper_cpu_s);
  return result;
}

MapOutcome MapRun::run(const Progress& progress, const std::function<bool()>& stop) {
  MapOutcome outcome;
  double first_s = std::numeric_limits<double>::infinity();
  double last_s = -first_s;
  Stopwatch whole;
  Stopwatch watch;
  NextScan next;
  if (!stop()) next.scan = next_scan(stop);
  watch.add_to(outcome.read_s);
  while (next.scan && !stop()) {
    const ScanRecord record = *std::exchange(next.scan, std::nullopt);
    const MatchResult result = map_scan(record, next, stop, watch, outcome);
    if (job_.with_occupancy && result.accepted) occupancy_.add(record.scan, result.T_map_base);
    note_match(result, result.T_map_base, outcome);
    first_s = std::min(first_s, result.stamp_s);
    last_s = std::max(last_s, result.stamp_s);
    progress(outcome.trajectory.size(), scans_.progress());
    watch.add_to(outcome.occupancy_s);
    if (next.problem && !stop()) std::rethrow_exception(next.problem);
  }
  outcome.interrupted = stop();
  outcome.warnings = scans_.warnings();
  outcome.statistics = mapper_.statistics();
  outcome.device_loss = mapper_.device_loss();
  require_a_map(job_, outcome, scans_.scans_read());
  if (job_.with_occupancy) outcome.occupancy = occupancy_.build();
  watch.add_to(outcome.occupancy_s);
  outcome.log_duration_s = last_s - first_s;
  whole.add_to(outcome.wall_s, outcome.cpu_s);
  return outcome;
}

}  // namespace gdtslam

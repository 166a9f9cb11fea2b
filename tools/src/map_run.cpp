#include "map_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <optional>

#include "gdtslam/core/error.hpp"
#include "log_check.hpp"

namespace gdtslam {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

OccupancyBuilder::Limits limits_of(const MapperConfig& config) {
  return {.resolution_m = config.map.resolution_m,
          .min_range_m = config.scan.min_range_m,
          .max_range_m = config.scan.max_range_m,
          .max_cells = static_cast<std::uint64_t>(config.map.max_megacells) << 20U};
}

}  // namespace

double process_cpu_s() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

MapRun::MapRun(const MapJob& job, Backend& backend)
    : with_occupancy_(job.with_occupancy),
      scan_(job.mapper.scan),
      range_(job.range),
      logs_(job.logs),
      scans_(job.logs, job.read, job.range),
      mapper_(job.mapper, backend),
      occupancy_(job.occupancy, limits_of(job.mapper)) {}

// A signal may cut the input in the middle of a line; what the reader says of that is not the user's concern.
std::optional<ScanRecord> MapRun::next_scan(const std::function<bool()>& stop) {
  try {
    return scans_.next();
  } catch (const InputError&) {
    if (!stop()) throw;
    return std::nullopt;
  }
}

void MapRun::note(const MatchResult& result, MapOutcome& outcome) const {
  if (result.doubt != Doubt::kNone) {
    const Pose2 off = between(result.T_map_predicted, result.T_map_base);
    outcome.doubtful.push_back({outcome.trajectory.size(), result.stamp_s, result.doubt, result.accepted,
                                off.translation().norm(), std::fabs(off.theta_rad)});
  }
  if (result.merged) outcome.keyframes.push_back(outcome.trajectory.size());
  outcome.trajectory.push_back({result.stamp_s, result.T_map_base});
}

// Without one merged scan there is no map to write.
void MapRun::require_a_map(const MapOutcome& outcome) const {
  if (outcome.statistics.keyframes > 0) return;
  const FilePosition place{log_name(logs_.front()), 0};
  if (outcome.interrupted) {
    throw Error(ExitCode::kInterrupted, outcome.trajectory.empty()
                                            ? "interrupted before the first scan; nothing is written"
                                            : "interrupted before a scan could be mapped; nothing is written");
  }
  if (!outcome.trajectory.empty()) throw InputError(place, nothing_mappable(outcome.trajectory.size(), scan_));
  if (scans_.scans_read() > 0) {
    throw InputError(place, fmt::format("--skip {} leaves none of its {} scans", range_.skip, scans_.scans_read()));
  }
  throw InputError(place, "holds no laser scan to map; 'gdtslam doctor' says what is in it");
}

MapOutcome MapRun::run(const Progress& progress, const std::function<bool()>& stop) {
  MapOutcome outcome;
  double first_s = std::numeric_limits<double>::infinity();
  double last_s = -first_s;
  const double cpu_start_s = process_cpu_s();
  const Clock::time_point start = Clock::now();
  Clock::time_point before = start;
  while (!(outcome.interrupted = stop())) {
    const std::optional<ScanRecord> record = next_scan(stop);
    const Clock::time_point read = Clock::now();
    outcome.read_s += seconds_between(before, read);
    before = read;
    if (!record) break;
    const double cpu_before_s = process_cpu_s();
    const MatchResult result = mapper_.process(record->scan, record->T_odom_base);
    outcome.mapper_cpu_s += process_cpu_s() - cpu_before_s;
    const Clock::time_point mapped = Clock::now();
    outcome.mapper_s += seconds_between(read, mapped);
    if (with_occupancy_ && result.accepted) occupancy_.add(record->scan, result.T_map_base);
    note(result, outcome);
    first_s = std::min(first_s, result.stamp_s);
    last_s = std::max(last_s, result.stamp_s);
    before = Clock::now();
    outcome.occupancy_s += seconds_between(mapped, before);
    progress(outcome.trajectory.size(), scans_.progress());
  }
  outcome.interrupted = stop();
  outcome.warnings = scans_.warnings();
  outcome.statistics = mapper_.statistics();
  require_a_map(outcome);
  if (with_occupancy_) outcome.occupancy = occupancy_.build();
  outcome.occupancy_s += seconds_between(before, Clock::now());
  outcome.log_duration_s = last_s - first_s;
  outcome.wall_s = seconds_between(start, Clock::now());
  outcome.cpu_s = process_cpu_s() - cpu_start_s;
  return outcome;
}

}  // namespace gdtslam

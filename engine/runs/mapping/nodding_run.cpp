#include "nodding_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/mapping/nodding/level_scan.hpp"
#include "gdtslam/core/error.hpp"
#include "stopwatch.hpp"

namespace gdtslam {

NoddingScanner scanner_of(const calib::SweepModel& model, NodKind kind) {
  return {.mount = model.mount,
          .table = kind == NodKind::kTilt ? ElevationTable::identity() : calib::elevation_table(model),
          .mirror_rate_hz = model.mirror_rate_hz,
          .stamp_share = model.stamp_share};
}

void NoddingRun::Splitter::add(std::span<const CloudPoint> points) {
  if (cloud_ != nullptr) cloud_->add(points);
  sampler_.add(points);
}

NoddingRun::NoddingRun(const MapJob& job, const NoddingJob& nodding, Backend& backend, ScanStream scans,
                       std::unique_ptr<CloudOutput> cloud)
    : job_(job),
      scanner_(scanner_of(nodding.model, nodding.kind)),
      scans_(std::move(scans)),
      stream_(scans_, nodding.kind, nodding.model, nodding.limits),
      mapper_(mapper_config_of(job.mapper, nodding.nodding), backend, job.on_failure),
      occupancy_(job.occupancy, occupancy_limits(job.mapper)),
      cloud_(std::move(cloud)),
      sampler_(nodding.check),
      splitter_(cloud_.get(), sampler_),
      nodding_(
          nodding.nodding, scanner_, mapper_, backend, splitter_,
          [this](const NoddingPose& pose, const NoddingScan& scan) { take(pose, scan, *outcome_in_hand_); },
          job.on_failure) {}

void NoddingRun::take(const NoddingPose& pose, const NoddingScan& scan, MapOutcome& outcome) {
  if (pose.match) {
    note_match(*pose.match, pose.T_map_base, outcome);
    if (job_.with_occupancy && pose.match->accepted) {
      occupancy_.add(level_scan(scan, scanner_), pose.T_map_base);
    }
  } else {
    outcome.trajectory.push_back({pose.stamp_s, pose.T_map_base});
  }
}

void NoddingRun::map_all(const MapRun::Progress& progress, const std::function<bool()>& stop, MapOutcome& outcome) {
  double first_s = std::numeric_limits<double>::infinity();
  double last_s = -first_s;
  std::uint64_t scans = 0;
  Stopwatch watch;
  while (!stop()) {
    std::optional<NoddingScan> scan;
    try {
      scan = stream_.next();
    } catch (const InputError&) {
      if (!stop()) throw;  // a signal may cut the input in the middle of a line
    }
    watch.add_to(outcome.read_s);
    if (!scan) break;
    first_s = std::min(first_s, scan->record.scan.stamp_s);
    last_s = std::max(last_s, scan->record.scan.stamp_s);
    nodding_.process(std::move(*scan));
    progress(++scans, scans_.progress());
    watch.add_to(outcome.mapper_s, outcome.mapper_cpu_s);
  }
  outcome.log_duration_s = scans > 0 ? last_s - first_s : 0.0;
  outcome.interrupted = stop();
  if (scans == 0) return;
  try {
    nodding_.finish();
  } catch (const InputError& error) {
    if (outcome.interrupted) {
      throw Error(ExitCode::kInterrupted, "interrupted before a scan could be placed; nothing is written");
    }
    throw InputError(FilePosition{log_name(job_.logs.front()), 0}, error.what());
  }
  watch.add_to(outcome.mapper_s, outcome.mapper_cpu_s);
}

void NoddingRun::finish(MapOutcome& outcome) {
  Stopwatch watch;
  outcome.warnings = scans_.warnings();
  for (LogReader::Warning& warning : stream_.warnings()) outcome.warnings.push_back(std::move(warning));
  for (const std::string& text : nodding_.warnings()) outcome.warnings.push_back({"no horizontal scan", 1, text});
  outcome.statistics = mapper_.statistics();
  outcome.device_loss = mapper_.device_loss();
  require_a_map(job_, outcome, scans_.scans_read());
  if (job_.with_occupancy) outcome.occupancy = occupancy_.build();
  watch.add_to(outcome.occupancy_s);
  nodding_outcome_.statistics = nodding_.statistics();
  nodding_outcome_.check = sampler_.finish();
  if (std::string doubt = nodding_outcome_.check.doubt(); !doubt.empty()) {
    outcome.warnings.push_back({"sweeps that do not agree", 1, std::move(doubt)});
  }
  if (cloud_) {
    nodding_outcome_.cloud = cloud_->finish();
    if (const double voxel_m = nodding_outcome_.cloud.voxel_m; voxel_m > cloud_->config().voxel_m) {
      outcome.warnings.push_back({"cloud thinned more than asked for", 1,
                                  fmt::format("its cubes filled cloud.max_megavoxels; the last ones have {:g} m, "
                                              "cloud.voxel is {:g} m",
                                              voxel_m, cloud_->config().voxel_m)});
    }
    nodding_outcome_.has_cloud = true;
  }
}

MapOutcome NoddingRun::run(const MapRun::Progress& progress, const std::function<bool()>& stop) {
  MapOutcome outcome;
  outcome_in_hand_ = &outcome;
  Stopwatch whole;
  map_all(progress, stop, outcome);
  finish(outcome);
  whole.add_to(outcome.wall_s, outcome.cpu_s);
  return outcome;
}

}  // namespace gdtslam

#include "run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>

#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "surfaces.hpp"

namespace gdtslam {
namespace {

constexpr double kFirstGate_m = 0.5;
constexpr double kGateSigmas = 10.0;
constexpr double kLeastGate_m = 0.03;

// One entry for each kind, with the first that was seen.
const char* kind_name(calib::SurfaceKind kind) {
  return kind == calib::SurfaceKind::kWall ? "wall" : kind == calib::SurfaceKind::kFloor ? "floor" : "ceiling";
}

void read_log(const std::string& path, const ReadOptions& options, StopCollector& collector, CalibrateOutcome& outcome,
              const std::function<void(double)>& progress, const std::function<bool()>& stop) {
  const std::unique_ptr<LogReader> reader = open_log(path, options);
  while (const std::optional<LogRecord> record = reader->next()) {
    collector.take(*record);
    progress(reader->progress());
    if (stop()) throw Error(ExitCode::kInterrupted, "interrupted while reading " + path + "; nothing was written");
  }
  merge_warnings(outcome.warnings, reader->warnings());
  merge_warnings(outcome.warnings, collector.finish_log(log_name(path)));
}

std::vector<NamedSurface> surfaces_of(const CalibrateJob& job) {
  std::vector<NamedSurface> surfaces = named_surfaces(job.surfaces);
  for (NamedSurface& named : surfaces) {
    if (job.distances_known && !named.has_distance) {
      throw UsageError(
          fmt::format("--known-distances: --surfaces gives no distance of {0}, write {0}=DISTANCE, as in "
                      "{0}=2m",
                      kind_name(named.surface.kind)));
    }
    named.surface.distance_known = job.distances_known;
    named.surface.heading_known = !job.headings_free;
  }
  return surfaces;
}

}  // namespace

// Two passes: the start may be degrees off, so at first a range counts for a surface that it misses by half a metre;
// with the linkage found so far the gate closes to the ranges' own scatter.
CalibrateOutcome run_calibration(const CalibrateJob& job, const std::function<void(double)>& progress,
                                 const std::function<bool()>& stop) {
  CalibrateOutcome outcome;
  outcome.start = job.start;
  outcome.max_elevation_rad = job.options.max_elevation_rad;
  const std::vector<NamedSurface> surfaces = surfaces_of(job);
  StopCollector collector(job.start, job.sector_rad);
  for (const std::string& log : job.logs) read_log(log, job.read, collector, outcome, progress, stop);
  const std::vector<calib::RangeObservation> all = collector.observations(job.sigma_m);
  outcome.statistics = collector.statistics();
  outcome.start_surfaces = placed_surfaces(surfaces, job.start, all);
  outcome.observations = all;
  calib::assign_surfaces(job.start, outcome.start_surfaces, kFirstGate_m, outcome.observations);
  outcome.result = calib::calibrate(job.start, outcome.start_surfaces, outcome.observations, job.options);

  outcome.observations = all;
  const double gate_m = std::max(kLeastGate_m, kGateSigmas * outcome.statistics.range_sigma_m);
  outcome.unassigned =
      calib::assign_surfaces(outcome.result.model, outcome.result.surfaces, gate_m, outcome.observations);
  outcome.result = calib::calibrate(job.start, outcome.start_surfaces, outcome.observations, job.options);
  outcome.distrust = calib::reason_for_distrust(outcome.result);
  return outcome;
}

}  // namespace gdtslam

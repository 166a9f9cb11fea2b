#include "calibrate_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>

#include "calibrate_surfaces.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {
namespace {

constexpr double kFirstGate_m = 0.5;
constexpr double kGateSigmas = 10.0;
constexpr double kLeastGate_m = 0.03;

void read_log(const std::string& path, const ReadOptions& options, StopCollector& collector, CalibrateOutcome& outcome,
              const std::function<void(double)>& progress, const std::function<bool()>& stop) {
  const std::unique_ptr<LogReader> reader = open_log(path, options);
  while (const std::optional<LogRecord> record = reader->next()) {
    collector.take(*record);
    progress(reader->progress());
    if (stop()) throw Error(ExitCode::kInterrupted, "interrupted while reading " + path + "; nothing was written");
  }
  for (const LogReader::Warning& warning : reader->warnings()) outcome.warnings.push_back(warning);
}

}  // namespace

// Two passes: the start may be degrees off, so at first a range counts for a surface that it misses by half a metre;
// with the linkage found so far the gate closes to the ranges' own scatter.
CalibrateOutcome run_calibration(const CalibrateJob& job, const std::function<void(double)>& progress,
                                 const std::function<bool()>& stop) {
  CalibrateOutcome outcome;
  outcome.start = job.start;
  outcome.max_elevation_rad = job.options.max_elevation_rad;
  StopCollector collector(job.start, job.sector_rad);
  for (const std::string& log : job.logs) read_log(log, job.read, collector, outcome, progress, stop);
  collector.finish();
  const std::vector<calib::RangeObservation> all = collector.observations(job.sigma_m);
  outcome.statistics = collector.statistics();
  outcome.start_surfaces = surfaces_of(job.surfaces, job.start, all);
  for (calib::CalibrationSurface& surface : outcome.start_surfaces) {
    surface.distance_known = job.distances_known;
    surface.heading_known = !job.headings_free;
  }
  outcome.observations = all;
  calib::assign_surfaces(job.start, outcome.start_surfaces, kFirstGate_m, outcome.observations);
  outcome.result = calib::calibrate(job.start, outcome.start_surfaces, outcome.observations, job.options);

  outcome.observations = all;
  const double gate_m = std::max(kLeastGate_m, kGateSigmas * outcome.statistics.range_sigma_m);
  outcome.unassigned =
      calib::assign_surfaces(outcome.result.model, outcome.result.surfaces, gate_m, outcome.observations);
  outcome.result = calib::calibrate(job.start, outcome.start_surfaces, outcome.observations, job.options);
  return outcome;
}

}  // namespace gdtslam

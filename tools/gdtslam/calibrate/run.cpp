#include "calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "engine/core/elementary.hpp"
#include "engine/core/quantile.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

constexpr double kFirstGate_m = 0.5;
constexpr double kGateSigmas = 10.0;
constexpr double kLeastGate_m = 0.03;
constexpr double kNearEdge = 0.1;  // share of the extreme ranges that is skipped, so that a few outliers do not matter
constexpr std::size_t kMostSurfaces = 16;
constexpr std::size_t kZerosTried = 144;    // 2.5 deg apart
constexpr std::size_t kRangesTried = 2000;  // an even sample

/// A surface from the options, with its distance from the nodding axis if given.
struct NamedSurface {
  calib::CalibrationSurface surface;
  bool has_distance = false;
};

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

std::string trimmed(const std::string& text) {
  const std::size_t from = text.find_first_not_of(" \t");
  return from == std::string::npos ? "" : text.substr(from, text.find_last_not_of(" \t") - from + 1);
}

calib::SurfaceKind parse_kind(const std::string& name) {
  if (name == "wall") return calib::SurfaceKind::kWall;
  if (name == "floor") return calib::SurfaceKind::kFloor;
  if (name == "ceiling") return calib::SurfaceKind::kCeiling;
  throw UsageError("--surfaces: '" + name + "' is no surface; there are wall, floor and ceiling");
}

NamedSurface parse_surface(const std::string& text) {
  NamedSurface result;
  const std::size_t at = text.find('@');
  const std::size_t equals = text.find('=');
  const std::string name = trimmed(text.substr(0, std::min(at, equals)));
  result.surface.kind = parse_kind(name);
  result.surface.name = name;
  if (equals != std::string::npos && equals < at) {
    result.has_distance = true;
    const std::size_t end = at == std::string::npos ? std::string::npos : at - equals - 1;
    result.surface.distance_m = quantity_of("--surfaces", text.substr(equals + 1, end), Unit::kMetre);
    if (!(result.surface.distance_m > 0.0))
      throw UsageError("--surfaces: the distance of " + name + " must be above 0");
  }
  if (at != std::string::npos) {
    if (result.surface.kind != calib::SurfaceKind::kWall)
      throw UsageError("--surfaces: only a wall has a heading, not " + name);
    result.surface.heading_rad = quantity_of("--surfaces", text.substr(at + 1), Unit::kRadian);
  }
  return result;
}

// Parses "wall", "wall=2m", "wall=2m@30deg,ceiling=2.2m,floor".
std::vector<NamedSurface> parse(const std::string& text) {
  std::vector<NamedSurface> list;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t end = std::min(text.find(',', from), text.size());
    list.push_back(parse_surface(text.substr(from, end - from)));
    from = end + 1;
  }
  if (list.size() > kMostSurfaces) throw UsageError("--surfaces: more than 16 surfaces");
  return list;
}

// Names them "wall", "wall2", ...: the parameters' names contain these.
void number_names(std::vector<NamedSurface>& list) {
  for (std::size_t k = 0; k < list.size(); ++k) {
    std::size_t before = 0;
    for (std::size_t i = 0; i < k; ++i) before += list[i].surface.kind == list[k].surface.kind ? 1U : 0U;
    if (before > 0) list[k].surface.name += std::to_string(before + 1);
  }
}

// Distance of a surface from the ranges along its normal. A wall uses its nearest ranges, because no beam meets it
// nearer than at its foot; floor and ceiling use the farthest. Empty if no range points that way.
std::optional<double> guessed_distance_m(const calib::CalibrationSurface& surface, const calib::SweepModel& start,
                                         const std::vector<calib::RangeObservation>& ranges) {
  std::vector<double> reaches_m;
  for (const calib::RangeObservation& range : ranges) {
    const std::optional<double> elevation = calib::elevation_rad(start, calib::crank_rad(start.encoder, range.ticks));
    if (!elevation) continue;
    if (surface.kind == calib::SurfaceKind::kWall) {
      const double aside = std::fabs(wrap_angle(range.bearing_rad - surface.heading_rad));
      if (aside < 0.35) reaches_m.push_back(range.range_m * sin_cos(aside).cos);
      continue;
    }
    const double up_m = range.range_m * sin_cos(range.bearing_rad).cos * sin_cos(*elevation).sin;
    const double reach_m = surface.kind == calib::SurfaceKind::kCeiling ? up_m : -up_m;
    if (reach_m > 0.0) reaches_m.push_back(reach_m);
  }
  if (reaches_m.empty()) return std::nullopt;
  return value_at_share(reaches_m, surface.kind == calib::SurfaceKind::kWall ? kNearEdge : 1.0 - kNearEdge);
}

// Guesses missing distances from the ranges, with the start's elevations.
std::vector<calib::CalibrationSurface> placed_surfaces(const std::vector<NamedSurface>& named,
                                                       const calib::SweepModel& start,
                                                       const std::vector<calib::RangeObservation>& ranges) {
  std::vector<calib::CalibrationSurface> surfaces;
  for (const NamedSurface& entry : named) {
    surfaces.push_back(entry.surface);
    if (entry.has_distance) continue;
    const std::optional<double> distance_m = guessed_distance_m(entry.surface, start, ranges);
    if (!distance_m) {
      throw InputError("no range tells how far " + entry.surface.name + " is; give its distance, as in --surfaces " +
                       entry.surface.name + "=2m");
    }
    surfaces.back().distance_m = *distance_m;
  }
  return surfaces;
}

// Whether each surface has a distance or one can be guessed.
bool can_be_placed(const std::vector<NamedSurface>& named, const calib::SweepModel& start,
                   const std::vector<calib::RangeObservation>& ranges) {
  return std::all_of(named.begin(), named.end(), [&](const NamedSurface& entry) {
    return entry.has_distance || guessed_distance_m(entry.surface, start, ranges).has_value();
  });
}

std::vector<NamedSurface> parse_surfaces(const CalibrateJob& job) {
  std::vector<NamedSurface> surfaces = parse(job.surfaces);
  number_names(surfaces);
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

// Ranges at a single crank position fit any linkage.
void require_turning(const StopStatistics& statistics) {
  if (statistics.stops > 1) return;
  throw InputError(
      statistics.stops == 0
          ? fmt::format("no beam of the {} scans comes back from a surface; check --sector and --surfaces",
                        statistics.scans)
          : fmt::format("in all {} scans ranges come back at one place of the crank only; does it turn? Let "
                        "it turn, or stop at many places",
                        statistics.scans));
}

// With a wrong zero most ranges miss their surfaces by more than the first gate, so the zero is searched before any
// range is rejected. O(zeros x ranges x surfaces).
calib::SweepModel with_sought_zero(const CalibrateJob& job, const std::vector<NamedSurface>& surfaces,
                                   const std::vector<calib::RangeObservation>& all, const std::function<bool()>& stop) {
  std::vector<calib::RangeObservation> some;
  const std::size_t step = std::max<std::size_t>(1, all.size() / kRangesTried);
  for (std::size_t k = 0; k < all.size(); k += step) some.push_back(all[k]);
  calib::SweepModel trial = job.start;
  calib::SweepModel best = job.start;
  double least_m = kFirstGate_m;
  for (std::size_t k = 0; k < kZerosTried; ++k) {
    if (stop()) throw Error(ExitCode::kInterrupted, "interrupted while calibrating; nothing was written");
    const double turn = static_cast<double>(k) / static_cast<double>(kZerosTried);
    trial.encoder.zero_rad = wrap_angle(job.start.encoder.zero_rad + kTwoPi * turn);
    if (!can_be_placed(surfaces, trial, some)) continue;
    const double miss_m = calib::mean_miss_m(trial, placed_surfaces(surfaces, trial, some), kFirstGate_m, some);
    if (miss_m >= least_m) continue;
    least_m = miss_m;
    best = trial;
  }
  return best;
}

}  // namespace

// Two passes: the start may be degrees off, so at first a range may miss its surface by half a metre. With the linkage
// found by then, the gate closes to the ranges' own scatter.
CalibrateOutcome run_calibration(const CalibrateJob& job, const std::function<void(double)>& progress,
                                 const std::function<bool()>& stop) {
  CalibrateOutcome outcome;
  outcome.start = job.start;
  outcome.max_elevation_rad = job.options.max_elevation_rad;
  calib::CalibrationOptions options = job.options;
  options.stop = stop;
  const std::vector<NamedSurface> surfaces = parse_surfaces(job);
  StopCollector collector(job.start, job.sector_rad);
  for (const std::string& log : job.logs) read_log(log, job.read, collector, outcome, progress, stop);
  const std::vector<calib::RangeObservation> all = collector.observations(job.sigma_m);
  outcome.statistics = collector.statistics();
  require_turning(outcome.statistics);
  const calib::SweepModel start = options.search_zero ? with_sought_zero(job, surfaces, all, stop) : job.start;
  outcome.start_surfaces = placed_surfaces(surfaces, start, all);
  outcome.observations = all;
  calib::assign_surfaces(start, outcome.start_surfaces, kFirstGate_m, outcome.observations);
  outcome.result = calib::calibrate(start, outcome.start_surfaces, outcome.observations, options);

  outcome.observations = all;
  const double gate_m = std::max(kLeastGate_m, kGateSigmas * outcome.statistics.range_sigma_m);
  outcome.unassigned =
      calib::assign_surfaces(outcome.result.model, outcome.result.surfaces, gate_m, outcome.observations);
  outcome.result = calib::calibrate(start, outcome.start_surfaces, outcome.observations, options);
  outcome.distrust = calib::reason_for_distrust(outcome.result);
  return outcome;
}

}  // namespace gdtslam

#include <algorithm>
#include <cmath>
#include <utility>

#include "gdtslam/calib/calibration.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "observability.hpp"

namespace gdtslam::calib {
namespace {

constexpr double kTightRoom_m = 0.0005;     // a smaller closing margin gets a remark
constexpr double kLeastSweep_rad = 0.1745;  // 10 deg
constexpr int kFirstRounds = 2;
constexpr double kNear = 100.0;             // below this share of the cost the other assembly gets a full fit
constexpr double kMuchBetter = 0.5;         // below this share of the cost the other assembly is correct
constexpr std::size_t kZeros = 144;         // 2.5 deg apart
constexpr std::size_t kObservations = 200;  // an even sample
constexpr double kMostMiss_m = 0.5;         // a larger one counts as this
// Objects before a wall give one outlier in ten; a wrong preset nine in ten.
constexpr double kMostOutliers = 1.0 / 3.0;
constexpr double kMostRms = 3.0;  // limit for all ranges if a bar was stopped by its bound

/// A start with its result.
struct Attempt {
  Setup start;
  std::vector<Parameter> parameters;
  Fit fit;
};

void require(const std::vector<std::string>& faults, const std::string& what) {
  if (!faults.empty()) throw ConfigError(what + ": " + faults.front());
}

void check_start(const SweepModel& start, const std::vector<CalibrationSurface>& surfaces,
                 const CalibrationOptions& options) {
  require(validate(options), "calibration");
  require(validate(start), "linkage '" + start.name + "'");
  if (closing_room_m(start.bars) <= 0.0) {
    throw ConfigError("linkage '" + start.name +
                      "': its loop does not close all around, so it is no start for a "
                      "calibration; `gdtslam linkage` shows where it closes");
  }
  if (surfaces.empty()) throw ConfigError("calibration: no surface was given, name at least a wall");
  for (const CalibrationSurface& surface : surfaces) {
    if (!(surface.distance_m > 0.0) || !std::isfinite(surface.distance_m) || !std::isfinite(surface.heading_rad)) {
      throw ConfigError("calibration: the distance of " + surface.name + " must be above zero");
    }
  }
}

void check_observations(const std::vector<RangeObservation>& observations, std::size_t surfaces) {
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const RangeObservation& seen = observations[k];
    const bool is_sound = std::isfinite(seen.ticks) && std::isfinite(seen.bearing_rad) && seen.range_m > 0.0 &&
                          std::isfinite(seen.range_m) && seen.sigma_m > 0.0 && std::isfinite(seen.sigma_m);
    if (!is_sound || seen.surface >= surfaces) {
      throw InputError(
          "observation " + std::to_string(k) +
          (is_sound ? " is of a surface that was not given" : " has a range or a sigma that is no length"));
    }
  }
}

void check_sweep(const Attempt& attempt) {
  const std::optional<Misses> misses =
      misses_at(setup_at(attempt.start, attempt.parameters, attempt.fit.x), attempt.fit.used);
  if (!misses) return;
  double low = kInfinity;
  double high = -kInfinity;
  for (const SurfaceMiss& miss : misses->list) {
    low = std::min(low, miss.elevation_rad);
    high = std::max(high, miss.elevation_rad);
  }
  if (high - low >= kLeastSweep_rad) return;
  throw InputError("the ranges cover " + std::to_string(static_cast<int>(deg_from_rad(high - low))) +
                   " deg of elevation, too little to calibrate a linkage; record a whole turn of the crank");
}

Attempt attempt(const Setup& start, const std::vector<RangeObservation>& observations,
                const CalibrationOptions& options, int rounds = kMostRounds) {
  Attempt result{.start = start, .parameters = make_parameters(start, options), .fit = {}};
  result.fit = fit(result.start, result.parameters, observations, options, rounds);
  return result;
}

double mean_assigned_miss_m(const Setup& setup, const std::vector<RangeObservation>& observations,
                            const CalibrationOptions& options) {
  const std::size_t step = std::max<std::size_t>(1, observations.size() / kObservations);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < observations.size(); k += step) {
    const RangeObservation& seen = observations[k];
    const CalibrationSurface& surface = setup.surfaces[seen.surface];
    const std::optional<SurfaceMiss> miss = surface_miss(setup.model, surface, seen);
    if (!miss) continue;
    const double measured = measured_elevation_rad(setup.model.mount, surface, seen, miss->elevation_rad);
    if (std::fabs(measured) > options.max_elevation_rad) continue;
    sum += std::min(std::fabs(miss->miss_m), kMostMiss_m);
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : kInfinity;
}

// The same bars in the other assembly with the same range of elevations: its course over a turn is the start's in
// reverse. psi of the crossed assembly at phi is -psi of the open one at -phi.
SweepModel other_assembly(const SweepModel& model) {
  SweepModel other = model;
  other.assembly = model.assembly == Assembly::kOpen ? Assembly::kCrossed : Assembly::kOpen;
  other.elevation_sign = -model.elevation_sign;
  return other;
}

// For a start with an unknown zero: the model with the encoder's zero that minimises the misses. O(crank angles x
// observations).
SweepModel best_zero(const Setup& setup, const SweepModel& model, const std::vector<RangeObservation>& observations,
                     const CalibrationOptions& options) {
  Setup trial{model, setup.surfaces};
  SweepModel best = model;
  double least = kInfinity;
  for (std::size_t k = 0; k < kZeros; ++k) {
    const double turn = static_cast<double>(k) / static_cast<double>(kZeros);
    trial.model.encoder.zero_rad = wrap_angle(model.encoder.zero_rad + kTwoPi * turn);
    const double miss = mean_assigned_miss_m(trial, observations, options);
    if (miss < least) {
      least = miss;
      best = trial.model;
    }
  }
  return best;
}

// The other assembly, fitted completely only if it is near; empty if no range is within the elevations.
std::optional<Attempt> other_attempt(const Attempt& best, const std::vector<RangeObservation>& observations,
                                     const CalibrationOptions& options) {
  const Setup turned{best_zero(best.start, other_assembly(best.start.model), observations, options),
                     best.start.surfaces};
  try {
    Attempt other = attempt(turned, observations, options, kFirstRounds);
    if (other.fit.cost < kNear * best.fit.cost) other = attempt(turned, observations, options);
    return other;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void add_surface_remarks(const std::vector<CalibrationSurface>& surfaces, std::vector<std::string>& remarks) {
  if (surfaces.size() > 1) return;
  remarks.emplace_back(
      "one " + std::string(surfaces.front().kind == SurfaceKind::kWall ? "wall" : "level surface") +
      " tells at most three ratios of the bars, the encoder's zero, one elevation offset (all that is fixed outside of "
      "the loop, together) and its own distance, not the bars' scale; it must be truly upright or level. A second "
      "surface, such as the ceiling, checks that");
}

std::vector<std::string> remarks_on(const Attempt& attempt, const Observability& seen,
                                    const CalibrationResult& result) {
  std::vector<std::string> remarks;
  add_surface_remarks(result.surfaces, remarks);
  const Setup setup{result.model, result.surfaces};
  for (const std::string& alias : alias_remarks(setup, attempt.parameters, seen, attempt.fit)) remarks.push_back(alias);
  for (const CalibratedParameter& parameter : result.parameters) {
    if (parameter.at_bound)
      remarks.push_back(parameter.name + " lies on its bound: the start is too far off, or the data are wrong");
  }
  if (closing_room_m(result.model.bars) < kTightRoom_m) {
    remarks.emplace_back("the loop closes with less than 0.5 mm to spare at its worst crank angle");
  }
  if (result.residual_rms > 2.0) remarks.emplace_back("the ranges scatter more than their sigma says");
  if (10 * result.outliers > result.observations) {
    remarks.push_back(std::to_string(result.outliers) + " of " + std::to_string(result.observations) +
                      " ranges do not fit: is something between the scanner and the surfaces?");
  }
  return remarks;
}

std::vector<double> row_major(const Eigen::MatrixXd& matrix) {
  std::vector<double> values;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) values.push_back(matrix(row, column));
  }
  return values;
}

CalibrationResult make_result(const Attempt& attempt, const CalibrationOptions& options) {
  const Setup found = setup_at(attempt.start, attempt.parameters, attempt.fit.x);
  const Observability seen = observe(found, attempt.parameters, attempt.fit, options.huber_sigmas);
  Eigen::VectorXd scales(static_cast<Eigen::Index>(attempt.parameters.size()));
  for (std::size_t i = 0; i < attempt.parameters.size(); ++i) {
    scales(static_cast<Eigen::Index>(i)) = attempt.parameters[i].scale;
  }
  CalibrationResult result;
  result.model = found.model;
  result.model.encoder.zero_rad = wrap_angle(found.model.encoder.zero_rad);
  result.surfaces = found.surfaces;
  result.parameters = described(attempt.parameters, attempt.fit.x, seen);
  result.covariance = row_major(scales.asDiagonal() * seen.covariance * scales.asDiagonal());
  result.singular_values = {seen.singular_values.data(), seen.singular_values.data() + seen.singular_values.size()};
  result.combinations = row_major(seen.combinations.transpose());
  result.weak = weak_combinations(found, attempt.parameters, seen);
  result.residual_rms = attempt.fit.rms;
  result.all_rms = attempt.fit.all_rms;
  result.elevation_sigma_rad = elevation_sigma_rad(found, attempt.parameters, seen, attempt.fit);
  result.observations = attempt.fit.used.size();
  result.outliers = attempt.fit.outliers;
  result.iterations = attempt.fit.iterations;
  result.converged = attempt.fit.converged;
  result.reason = attempt.fit.reason;
  result.remarks = remarks_on(attempt, seen, result);
  return result;
}

std::string rounded(double value) {
  const double tenths = std::floor(10.0 * value + 0.5);
  if (!(tenths < 1e9)) return "over 1e8";
  const auto whole = static_cast<std::uint64_t>(tenths);
  return std::to_string(whole / 10) + "." + std::to_string(whole % 10);
}

}  // namespace

CalibrationResult calibrate(const SweepModel& start, const std::vector<CalibrationSurface>& surfaces,
                            const std::vector<RangeObservation>& observations, const CalibrationOptions& options) {
  check_start(start, surfaces, options);
  check_observations(observations, surfaces.size());
  Setup setup{start, surfaces};
  if (options.search_zero) setup.model = best_zero(setup, start, observations, options);
  Attempt best = attempt(setup, observations, options);
  double other_rms = kInfinity;
  if (options.try_both_assemblies) {
    if (std::optional<Attempt> other = other_attempt(best, observations, options)) {
      if (other->fit.cost < kMuchBetter * best.fit.cost) std::swap(best, *other);
      other_rms = other->fit.all_rms;
    }
  }
  check_sweep(best);
  CalibrationResult result = make_result(best, options);
  result.other_assembly_rms = other_rms;
  if (result.model.assembly != start.assembly) {
    result.remarks.emplace_back("the other assembly fits much better than that of the start, and was taken");
  }
  return result;
}

bool is_bar(std::string_view name) {
  return name == "crank" || name == "coupler" || name == "rocker" || name == "ground";
}

std::string reason_for_distrust(const CalibrationResult& result) {
  if (static_cast<double>(result.outliers) > kMostOutliers * static_cast<double>(result.observations)) {
    return std::to_string(result.outliers) + " of " + std::to_string(result.observations) +
           " ranges do not fit the surfaces";
  }
  if (!result.converged) return "the fit did not converge (" + result.reason + ")";
  if (result.all_rms <= kMostRms) return "";
  for (const CalibratedParameter& parameter : result.parameters) {
    if (parameter.at_bound && is_bar(parameter.name)) {
      return parameter.name + " lies on its bound and the ranges miss the surfaces by " + rounded(result.all_rms) +
             " sigma";
    }
  }
  return "";
}

}  // namespace gdtslam::calib

#include "start_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

constexpr std::size_t kZeros = 144;         // 2.5 deg apart
constexpr std::size_t kObservations = 200;  // of all, spread evenly
constexpr double kMostMiss_m = 0.5;         // a larger one counts as this

double mean_miss_m(const Setup& setup, const std::vector<RangeObservation>& observations,
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
  return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::infinity();
}

}  // namespace

// psi of the crossed assembly at phi is -psi of the open one at -phi.
SweepModel other_assembly(const SweepModel& model) {
  SweepModel other = model;
  other.assembly = model.assembly == Assembly::kOpen ? Assembly::kCrossed : Assembly::kOpen;
  other.elevation_sign = -model.elevation_sign;
  return other;
}

SweepModel best_zero(const Setup& setup, const SweepModel& model, const std::vector<RangeObservation>& observations,
                     const CalibrationOptions& options) {
  Setup trial{model, setup.surfaces};
  SweepModel best = model;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < kZeros; ++k) {
    const double turn = static_cast<double>(k) / static_cast<double>(kZeros);
    trial.model.encoder.zero_rad = wrap_angle(model.encoder.zero_rad + kTwoPi * turn);
    const double miss = mean_miss_m(trial, observations, options);
    if (miss < least) {
      least = miss;
      best = trial.model;
    }
  }
  return best;
}

}  // namespace gdtslam::calib

// One bounded robust least-squares fit, (A2): from one start, in one assembly.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "parameters.hpp"

namespace gdtslam::calib {

/// An observation in the fit: `gain` turns its miss into standard deviations. It follows from the measured range, so
/// that no step of the solver can buy a better fit by making a measurement worthless.
struct WeightedObservation {
  RangeObservation observation;
  double gain = 1.0;
};

/// Rounds of weighing and solving; two or three do but for a start that is far off.
inline constexpr int kMostRounds = 12;

struct Fit {
  std::vector<double> x;  ///< scaled, from the start
  std::vector<WeightedObservation> used;
  double cost = 0.0;     ///< robust, priors included, per observation used
  double rms = 0.0;      ///< RMS of the weighted misses without the outliers
  double all_rms = 0.0;  ///< RMS of all weighted misses
  std::uint64_t outliers = 0;
  int iterations = 0;
  bool converged = false;
  std::string reason;
};

/// Throws InputError when too few observations lie within the elevations asked for, Error(kInterrupted) where
/// options.stop says so. The loop closes at the start.
Fit fit(const Setup& start, std::span<const Parameter> parameters, std::span<const RangeObservation> observations,
        const CalibrationOptions& options, int rounds = kMostRounds);

/// The weighted misses at x; nothing where the loop does not close all around.
struct Misses {
  std::vector<SurfaceMiss> list;
  std::vector<double> weighted;
};
std::optional<Misses> misses_at(const Setup& setup, std::span<const WeightedObservation> observations);

}  // namespace gdtslam::calib

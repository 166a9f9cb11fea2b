// One bounded robust least-squares fit, (A2), from one start in one assembly.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "parameters.hpp"

namespace gdtslam::calib {

/// An observation in the fit: `gain` converts its miss to standard deviations. It depends on the measured range, so
/// that the solver cannot improve the fit by making a measurement worthless.
struct WeightedObservation {
  RangeObservation observation;
  double gain = 1.0;
};

/// Limit of rounds of weighing and solving; two or three suffice unless the start is far off.
inline constexpr int kMostRounds = 12;

struct Fit {
  std::vector<double> x;  ///< scaled, relative to the start
  std::vector<WeightedObservation> used;
  double cost = 0.0;     ///< robust, priors included, per observation used
  double rms = 0.0;      ///< RMS of the weighted misses without the outliers
  double all_rms = 0.0;  ///< RMS of all weighted misses
  std::uint64_t outliers = 0;
  int iterations = 0;
  bool converged = false;
  std::string reason;
};

/// Throws InputError if too few observations are within the elevation limit, Error(kInterrupted) if options.stop
/// returns true. The loop must close at the start.
Fit fit(const Setup& start, std::span<const Parameter> parameters, std::span<const RangeObservation> observations,
        const CalibrationOptions& options, int rounds = kMostRounds);

/// The weighted misses at x; empty if the loop does not close all around.
struct Misses {
  std::vector<SurfaceMiss> list;
  std::vector<double> weighted;
};
std::optional<Misses> misses_at(const Setup& setup, std::span<const WeightedObservation> observations);

}  // namespace gdtslam::calib

// Calibration of a nodding mount from ranges to known kinds of surfaces, the paper's appendix: (A1) as READING corrects
// it, (A2) as bounded robust least squares with a prior on the bars' errors and a guard against loops that do not
// close. For each parameter: estimate, standard deviation, whether it lies on its bound, whether the data observe it.
// SI units, radians. Cost: a second for 100,000 ranges (they are averaged where the crank stood). Thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"

namespace gdtslam::calib {

enum class SurfaceKind : std::uint8_t { kWall, kFloor, kCeiling };

/// A flat surface that the standing scanner sees; its parameters are estimated too.
struct CalibrationSurface {
  std::string name;
  SurfaceKind kind = SurfaceKind::kWall;
  double distance_m = 2.0;   ///< of a wall from the axis (level, along heading); of floor or ceiling from the axis
  double heading_rad = 0.0;  ///< of the wall's normal, seen from the scanner; walls only
  bool distance_known = false;
};

/// One range, or the mean of several from a crank that stood.
struct RangeObservation {
  double ticks = 0.0;
  double bearing_rad = 0.0;
  double range_m = 0.0;
  double sigma_m = 0.01;  ///< of the mean
  std::uint32_t count = 1;
  std::uint32_t surface = 0;
};

struct CalibrationOptions {
  double bar_bound_m = 0.005;   ///< delta of each bar, (A2)
  double bar_prior_m = 0.0029;  ///< standard deviation of the prior; 0: no prior
  double zero_prior_rad = 0.0349;
  double offset_prior_rad = 0.0873;
  double distance_prior_m = 0.05;
  double lever_prior_m = 0.02;
  bool free_lever = false;
  bool free_sensor_angles = false;
  double huber_sigmas = 3.0;
  double max_elevation_rad = 1.0471975511965976;  ///< ranges above are not used
  bool try_both_assemblies = true;
};

struct CalibratedParameter {
  std::string name;  ///< crank, coupler, rocker, ground, zero, offset, distance.wall, lever.forward, ...
  std::string unit;  ///< m or rad
  double start = 0.0;
  double estimate = 0.0;
  double sigma = 0.0;       ///< posterior, prior included
  double data_share = 0.0;  ///< 1 - (sigma / prior sigma)^2: 0 the data say nothing, 1 they say all
  bool at_bound = false;
  bool observable = false;
};

/// A combination of parameters that the data leave free.
struct WeakCombination {
  double singular_value = 0.0;  ///< relative to the largest
  std::vector<double> weights;  ///< one per parameter, scaled by the priors, length 1
  std::string text;             ///< "crank + coupler + rocker + ground grow together (scale)"
};

struct CalibrationResult {
  SweepModel model;
  std::vector<CalibratedParameter> parameters;
  std::vector<double> covariance;  ///< row-major, posterior, in the parameters' order
  std::vector<double> singular_values;
  std::vector<WeakCombination> weak;
  double residual_rms = 0.0;         ///< of the weighted residuals: 1 where sigma is right
  double elevation_sigma_rad = 0.0;  ///< RMS over the sweep used
  std::uint64_t observations = 0;
  std::uint64_t outliers = 0;
  int iterations = 0;
  bool converged = false;
  std::string reason;  ///< why the solver stopped
  double other_assembly_rms = 0.0;
  std::vector<std::string> remarks;  ///< what one wall cannot tell, bounds hit, ...
};

/// Throws ConfigError for bad options or a start whose loop does not close, InputError for too few observations or a
/// sweep that is too short, with what to do.
CalibrationResult calibrate(const SweepModel& start, const std::vector<CalibrationSurface>& surfaces,
                            const std::vector<RangeObservation>& observations, const CalibrationOptions& options);

}  // namespace gdtslam::calib

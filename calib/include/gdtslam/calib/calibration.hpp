// Calibration of a nodding mount from ranges to surfaces of known kinds, the paper's appendix. docs/paper.md has (A1);
// (A2) is bounded robust least squares with a prior on the bars' errors and a guard against loops that do not close.
// Results per parameter: estimate, standard deviation, whether it is on its bound, whether the data observe it. SI
// units, radians. Cost depends on the number of averages, not of ranges: 0.15 s for 150 averages of one beam, 10 s for
// 41 beams before two surfaces. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"

namespace gdtslam::calib {

enum class SurfaceKind : std::uint8_t { kWall, kFloor, kCeiling };

/// A flat surface that the standing scanner sees; its parameters are estimated too.
struct CalibrationSurface {
  std::string name;
  SurfaceKind kind = SurfaceKind::kWall;
  double distance_m =
      2.0;  ///< distance of a wall from the axis (level, along heading); of floor or ceiling from the axis
  double heading_rad = 0.0;  ///< direction of the wall's normal, seen from the scanner; walls only
  bool distance_known = false;
  bool heading_known = true;  ///< a free heading needs beams of several bearings
};

/// One range, or the mean of several from a standing crank.
struct RangeObservation {
  double ticks = 0.0;
  double bearing_rad = 0.0;
  double range_m = 0.0;
  double sigma_m = 0.01;  ///< sigma of the mean
  std::uint32_t count = 1;
  std::uint32_t surface = 0;
};

/// Bounds and priors of the calibration, and which parameters are free.
struct CalibrationOptions {
  double bar_bound_m = 0.005;   ///< delta of each bar, (A2)
  double bar_prior_m = 0.0029;  ///< standard deviation of the prior; 0: no prior
  double zero_prior_rad = 0.0349;
  double offset_prior_rad = 0.0873;
  double distance_prior_m = 0.05;
  double lever_prior_m = 0.02;
  double angle_prior_rad = 0.0349;  ///< for the sensor's roll and yaw and a wall's heading
  bool free_lever = false;
  bool free_sensor_angles = false;
  double huber_sigmas = 3.0;
  double max_elevation_rad = 1.0471975511965976;  ///< ranges above are not used
  bool try_both_assemblies = true;
  bool search_zero = false;      ///< the encoder's zero is unknown: the whole turn is searched, without its prior
  std::function<bool()> stop{};  ///< polled; true ends the calibration with Error(kInterrupted)
  /// Returns the options without any prior. A parameter that the data do not determine keeps its start value, within
  /// its bounds.
  [[nodiscard]] CalibrationOptions without_priors() const;
};
/// Every violation, one sentence each.
std::vector<std::string> validate(const CalibrationOptions& options);

/// One parameter after the calibration, and how well the data determine it.
struct CalibratedParameter {
  std::string name;  ///< crank, coupler, rocker, ground, zero, offset, distance.wall, lever.forward, ...
  std::string unit;  ///< m or rad
  double start = 0.0;
  double estimate = 0.0;
  double sigma = 0.0;       ///< posterior, prior included; infinite if undetermined
  double data_share = 0.0;  ///< 1 - (sigma / prior sigma)^2: 0: no information from the data, 1: all from the data
  bool at_bound = false;
  bool observable = false;  ///< the data alone determine it to half of its prior's sigma or better
};

/// Whether a parameter of this name is the length of a bar.
bool is_bar(std::string_view name);

/// A combination of parameters that the data leave free.
struct WeakCombination {
  double singular_value = 0.0;  ///< prior's sigma over that of the data alone: below 1 the prior is stronger; 0: free
  std::vector<double> weights;  ///< one per parameter, scaled by the priors, length 1
  std::string text;             ///< "crank + coupler + rocker + ground grow together (scale)"
};

/// The calibrated mount, its uncertainty, and its fit to the ranges.
struct CalibrationResult {
  SweepModel model;
  std::vector<CalibratedParameter> parameters;
  std::vector<CalibrationSurface> surfaces;  ///< the estimate
  std::vector<double> covariance;            ///< row-major, posterior, in the parameters' order
  std::vector<double> singular_values;       ///< from the data alone, parameters scaled by their priors, descending
  std::vector<double> combinations;          ///< row-major, one row of weights for each singular value
  std::vector<WeakCombination> weak;
  double residual_rms = 0.0;         ///< RMS of the weighted residuals without outliers: 1 if sigma is correct
  double all_rms = 0.0;              ///< RMS of all residuals: well above 1 if many ranges do not fit
  double elevation_sigma_rad = 0.0;  ///< RMS over the sweep used
  std::uint64_t observations = 0;    ///< used: within max_elevation_rad
  std::uint64_t outliers = 0;        ///< residuals beyond huber_sigmas
  int iterations = 0;
  bool converged = false;
  std::string reason;                ///< why the solver stopped
  double other_assembly_rms = 0.0;   ///< infinite if it was not tried or does not fit at all
  std::vector<std::string> remarks;  ///< limits of a single wall, bounds that were hit, ...
};

/// Throws ConfigError for bad options or a start whose loop does not close. Throws InputError, with advice, for too few
/// observations or a sweep that is too short.
CalibrationResult calibrate(const SweepModel& start, const std::vector<CalibrationSurface>& surfaces,
                            const std::vector<RangeObservation>& observations, const CalibrationOptions& options);

/// Reason not to use the result, as part of a sentence: it did not converge, more than a third of the ranges do not
/// fit, or a bar hit its bound although the ranges miss. Standard deviations are then meaningless, because they assume
/// a correct model. Empty if there is no such reason.
std::string reason_for_distrust(const CalibrationResult& result);

/// Assigns to each observation the surface that the model expects it to meet first. Removes those that miss it by more
/// than `gate_m` or meet none; returns their number.
std::size_t assign_surfaces(const SweepModel& model, const std::vector<CalibrationSurface>& surfaces, double gate_m,
                            std::vector<RangeObservation>& observations);

/// Mean miss from the surface that the model expects each observation to meet first, metres. Larger misses, and
/// observations that meet none, count as `most_m`. 0 without observations.
double mean_miss_m(const SweepModel& model, const std::vector<CalibrationSurface>& surfaces, double most_m,
                   const std::vector<RangeObservation>& observations);

/// One of the seven bars of the paper's appendix (L1..L7 = nominal + delta) under a preset's reading of the figure.
struct PaperBar {
  std::string name;   ///< delta1 .. delta7
  std::string place;  ///< crank, coupler, rocker, ground; empty: not in the loop, but part of the offset
};
/// All seven; empty if the model's name is no preset of the paper.
std::vector<PaperBar> paper_bars(const std::string& model_name);

}  // namespace gdtslam::calib

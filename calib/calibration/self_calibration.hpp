// Calibration of a nodding mount from a mapping log, without known surroundings: what the laser saw while it was lifted
// and while it came down must be the same surfaces. Point-to-plane misses between consecutive strokes
// [ChenMedioni1992], least squares with the priors of calibration.hpp, pairs found anew in each round. A standing robot
// observes the encoder's zero and what else differs between the strokes; what moves both alike (the elevation offset
// first of all) stays as it was and is said to. SI units, frame of the map. Thread-safe. Cost: twice the parameters
// times an assembly a round.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/calib/calibration.hpp"

namespace gdtslam::calib {

/// The points of all strokes under a model, always the same points in the same order.
using StrokeAssembly = std::function<std::vector<Point3>(const SweepModel&)>;

struct SelfCalibrationOptions {
  /// Its bounds and priors, free_lever and free_sensor_angles. The bars are held tighter than before a wall, because
  /// two strokes tell little of them: what moved on a calibrated mount is most likely the encoder's zero.
  CalibrationOptions priors{.bar_prior_m = 0.0003};
  double first_gate_m = 0.3;  ///< limit of a pair's miss; halved each round down to last_gate_m
  double last_gate_m = 0.08;
  double sigma_m = 0.01;           ///< least standard deviation of a miss
  std::uint32_t max_pairs = 6000;  ///< spread evenly over the points
  std::uint32_t max_rounds = 15;
};

struct SelfCalibrationResult {
  SweepModel model;
  std::vector<CalibratedParameter> parameters;
  std::vector<double> singular_values;
  std::vector<WeakCombination> weak;
  std::uint32_t pairs = 0;
  std::uint32_t rounds = 0;
  double median_miss_before_m = 0.0;
  double median_miss_m = 0.0;
  bool converged = false;
  std::vector<std::string> remarks;
};

/// Why the result must not be used, as part of a sentence: the strokes did not settle. Empty where they did.
std::string reason_for_distrust(const SelfCalibrationResult& result);

/// `strokes` has the number of each point's stroke; a point is compared with those of the next stroke. Throws
/// ConfigError for a start whose loop does not close, InputError where the strokes share no surface.
SelfCalibrationResult self_calibrate(const SweepModel& start, const std::vector<std::uint32_t>& strokes,
                                     const StrokeAssembly& assemble, const SelfCalibrationOptions& options);

}  // namespace gdtslam::calib

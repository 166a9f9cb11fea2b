// Calibration of a nodding mount from a mapping log in unknown surroundings: the surfaces seen during lifting and
// lowering must coincide. Least squares over point-to-plane misses between consecutive strokes [ChenMedioni1992] with
// the priors of calibration.hpp; each round finds new pairs. A standing robot observes the encoder's zero and other
// differences between the strokes. Parameters that move both strokes alike (above all the elevation offset) keep their
// values, with a remark. SI units, frame of the map. Thread-safe. Cost: twice the parameters times an assembly per
// round.
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
  /// Its bounds and priors, free_lever and free_sensor_angles. The bars have tighter priors than with a wall, because
  /// two strokes determine them poorly: on a calibrated mount the encoder's zero is most likely to have moved.
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

/// Reason not to use the result, as part of a sentence: the strokes did not converge. Empty if there is none.
std::string reason_for_distrust(const SelfCalibrationResult& result);

/// `strokes` has the stroke number of each point; points are compared with the next stroke. Throws ConfigError for a
/// start whose loop does not close, InputError if the strokes share no surface.
SelfCalibrationResult self_calibrate(const SweepModel& start, const std::vector<std::uint32_t>& strokes,
                                     const StrokeAssembly& assemble, const SelfCalibrationOptions& options);

}  // namespace gdtslam::calib

#include <cmath>

#include "gdtslam/calib/calibration.hpp"
#include "self_calibration.hpp"

namespace gdtslam::calib {
namespace {

// A wall with things before it gives one outlier in ten; the wrong preset nine in ten.
constexpr double kMostOutliers = 1.0 / 3.0;
constexpr double kMostRms = 3.0;  // of all ranges, where a bar was stopped by its bound

bool is_bar(const std::string& name) {
  return name == "crank" || name == "coupler" || name == "rocker" || name == "ground";
}

std::string rounded(double value) {
  const double tenths = std::floor(10.0 * value + 0.5);
  if (!(tenths < 1e9)) return "over 1e8";
  const auto whole = static_cast<std::uint64_t>(tenths);
  return std::to_string(whole / 10) + "." + std::to_string(whole % 10);
}

}  // namespace

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

std::string reason_for_distrust(const SelfCalibrationResult& result) {
  return result.converged ? "" : "the strokes did not settle within " + std::to_string(result.rounds) + " rounds";
}

}  // namespace gdtslam::calib

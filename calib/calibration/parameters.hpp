// The unknowns of a calibration, each scaled by its prior sigma, so that a step of 1 means as much for a bar as for an
// angle. A vector of values x holds (parameter - start) / scale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "calibration_residual.hpp"

namespace gdtslam::calib {

/// Estimate of the scanner and its surroundings.
struct Setup {
  SweepModel model;
  std::vector<CalibrationSurface> surfaces;
};

/// The quantity that a parameter affects.
enum class Effect : std::uint8_t { kElevation, kMiss, kMissOfItsSurface };

/// A parameter that can be estimated: its value in a setup and its derivative.
struct ParameterKind {
  const char* name;
  double& (*value)(Setup& setup, std::size_t surface);
  double SurfaceMiss::*by;
  Effect effect;
};

struct Parameter {
  const ParameterKind* kind = nullptr;
  std::size_t surface = 0;  ///< surface of a distance or a heading
  std::string name;
  std::string unit;
  double start = 0.0;
  double scale = 1.0;        ///< the prior's sigma, or a default without a prior
  double prior_sigma = 0.0;  ///< 0: none
  double bound = 0.0;        ///< limit of the change in either direction
  [[nodiscard]] double bound_scaled() const { return bound / scale; }
};

std::vector<Parameter> make_parameters(const Setup& start, const CalibrationOptions& options);
Setup setup_at(const Setup& start, std::span<const Parameter> parameters, std::span<const double> x);
/// d miss / d x.
double derivative(const SurfaceMiss& miss, const Parameter& parameter, std::uint32_t observed_surface);
/// d elevation / d x, of the miss's beam.
double elevation_derivative(const SurfaceMiss& miss, const Parameter& parameter);
/// Margin in metres by which the loop closes at the worst crank angle; below 0 it does not close all around.
double closing_room_m(const FourBar& bars);

}  // namespace gdtslam::calib

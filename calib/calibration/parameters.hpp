// The unknowns of a calibration, each scaled by what is known of it beforehand, so that a step of 1 means as much for a
// bar as for an angle. A vector of values x holds (parameter - start) / scale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "calibration_residual.hpp"

namespace gdtslam::calib {

/// A belief about the scanner and its surroundings.
struct Setup {
  SweepModel model;
  std::vector<CalibrationSurface> surfaces;
};

/// The quantity that moves when a parameter changes.
enum class Effect : std::uint8_t { kElevation, kMiss, kMissOfItsSurface };

/// Something that can be estimated: its value in a setup and its derivative.
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
  double scale = 1.0;        ///< the prior's sigma, or its default where there is no prior
  double prior_sigma = 0.0;  ///< 0: none
  double bound = 0.0;        ///< limit of the change, either way
  [[nodiscard]] double bound_scaled() const { return bound / scale; }
};

std::vector<Parameter> make_parameters(const Setup& start, const CalibrationOptions& options);
Setup setup_at(const Setup& start, std::span<const Parameter> parameters, std::span<const double> x);
/// d miss / d x.
double derivative(const SurfaceMiss& miss, const Parameter& parameter, std::uint32_t observed_surface);
/// d elevation / d x, of the beam that the miss belongs to.
double elevation_derivative(const SurfaceMiss& miss, const Parameter& parameter);
/// By how much the loop closes all around, metres: the bars' room at the worst crank angle. Below 0 it does not.
double closing_room_m(const FourBar& bars);

}  // namespace gdtslam::calib

#include "parameters.hpp"

#include <algorithm>
#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

constexpr double kDistanceBound_m = 0.5;
constexpr double kLeverBound_m = 0.2;
constexpr double kAngleBound_rad = kPi / 4.0;
constexpr double kOffsetBound_rad = kPi / 2.0;

// The value of a parameter in a setup.
double& value_of(Setup& setup, const Parameter& parameter) {
  SweepModel& model = setup.model;
  switch (parameter.kind) {
    case ParameterKind::kCrank:
      return model.bars.crank_m;
    case ParameterKind::kCoupler:
      return model.bars.coupler_m;
    case ParameterKind::kRocker:
      return model.bars.rocker_m;
    case ParameterKind::kGround:
      return model.bars.ground_m;
    case ParameterKind::kZero:
      return model.encoder.zero_rad;
    case ParameterKind::kOffset:
      return model.elevation_offset_rad;
    case ParameterKind::kLeverForward:
      return model.mount.lever_forward_m;
    case ParameterKind::kLeverUp:
      return model.mount.lever_up_m;
    case ParameterKind::kRoll:
      return model.mount.sensor_roll_rad;
    case ParameterKind::kYaw:
      return model.mount.sensor_yaw_rad;
    case ParameterKind::kDistance:
      return setup.surfaces[parameter.surface].distance_m;
    case ParameterKind::kHeading:
      break;
  }
  return setup.surfaces[parameter.surface].heading_rad;
}

struct Family {
  std::string unit;
  double prior = 0.0;          ///< as the options have it, 0 for none
  double default_scale = 1.0;  ///< what a step of 1 means without a prior
  double bound = 0.0;
};

class ParameterList {
 public:
  explicit ParameterList(Setup start) : start_(std::move(start)) {}
  void add(ParameterKind kind, const std::string& name, const Family& family, std::size_t surface = 0) {
    Parameter parameter{.kind = kind,
                        .surface = surface,
                        .name = name,
                        .unit = family.unit,
                        .scale = family.prior > 0.0 ? family.prior : family.default_scale,
                        .prior_sigma = family.prior,
                        .bound = family.bound};
    parameter.start = value_of(start_, parameter);
    list.push_back(std::move(parameter));
  }
  std::vector<Parameter> list;

 private:
  Setup start_;
};

}  // namespace

std::vector<Parameter> parameters_of(const Setup& start, const CalibrationOptions& options) {
  const CalibrationOptions defaults;
  const Family bar{"m", options.bar_prior_m, defaults.bar_prior_m, options.bar_bound_m};
  const Family zero{"rad", options.search_zero ? 0.0 : options.zero_prior_rad, defaults.zero_prior_rad, kPi};
  const Family offset{"rad", options.offset_prior_rad, defaults.offset_prior_rad, kOffsetBound_rad};
  const Family lever{"m", options.lever_prior_m, defaults.lever_prior_m, kLeverBound_m};
  const Family angle{"rad", options.angle_prior_rad, defaults.angle_prior_rad, kAngleBound_rad};
  const Family distance{"m", options.distance_prior_m, defaults.distance_prior_m, kDistanceBound_m};
  ParameterList parameters(start);
  parameters.add(ParameterKind::kCrank, "crank", bar);
  parameters.add(ParameterKind::kCoupler, "coupler", bar);
  parameters.add(ParameterKind::kRocker, "rocker", bar);
  parameters.add(ParameterKind::kGround, "ground", bar);
  parameters.add(ParameterKind::kZero, "zero", zero);
  parameters.add(ParameterKind::kOffset, "offset", offset);
  if (options.free_lever) {
    parameters.add(ParameterKind::kLeverForward, "lever.forward", lever);
    parameters.add(ParameterKind::kLeverUp, "lever.up", lever);
  }
  if (options.free_sensor_angles) {
    parameters.add(ParameterKind::kRoll, "sensor.roll", angle);
    parameters.add(ParameterKind::kYaw, "sensor.yaw", angle);
  }
  for (std::size_t k = 0; k < start.surfaces.size(); ++k) {
    const CalibrationSurface& surface = start.surfaces[k];
    if (!surface.distance_known) parameters.add(ParameterKind::kDistance, "distance." + surface.name, distance, k);
    if (!surface.heading_known && surface.kind == SurfaceKind::kWall) {
      parameters.add(ParameterKind::kHeading, "heading." + surface.name, angle, k);
    }
  }
  return std::move(parameters.list);
}

Setup setup_at(const Setup& start, std::span<const Parameter> parameters, std::span<const double> x) {
  Setup setup = start;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    value_of(setup, parameters[i]) = parameters[i].start + parameters[i].scale * x[i];
  }
  return setup;
}

double elevation_derivative(const SurfaceMiss& miss, const Parameter& parameter) {
  switch (parameter.kind) {
    case ParameterKind::kCrank:
      return parameter.scale * miss.elevation_by_crank;
    case ParameterKind::kCoupler:
      return parameter.scale * miss.elevation_by_coupler;
    case ParameterKind::kRocker:
      return parameter.scale * miss.elevation_by_rocker;
    case ParameterKind::kGround:
      return parameter.scale * miss.elevation_by_ground;
    case ParameterKind::kZero:
      return parameter.scale * miss.elevation_by_zero;
    case ParameterKind::kOffset:
      return parameter.scale;
    default:
      return 0.0;
  }
}

double derivative(const SurfaceMiss& miss, const Parameter& parameter, std::uint32_t observed_surface) {
  const bool is_seen = parameter.surface == observed_surface;
  switch (parameter.kind) {
    case ParameterKind::kLeverForward:
      return parameter.scale * miss.by_lever_forward;
    case ParameterKind::kLeverUp:
      return parameter.scale * miss.by_lever_up;
    case ParameterKind::kRoll:
      return parameter.scale * miss.by_roll;
    case ParameterKind::kYaw:
      return parameter.scale * miss.by_yaw;
    case ParameterKind::kDistance:
      return is_seen ? parameter.scale * miss.by_distance : 0.0;
    case ParameterKind::kHeading:
      return is_seen ? parameter.scale * miss.by_heading : 0.0;
    default:
      return miss.by_elevation * elevation_derivative(miss, parameter);
  }
}

double closing_room_m(const FourBar& bars) {
  const double outside = bars.coupler_m + bars.rocker_m - (bars.ground_m + bars.crank_m);
  const double inside = std::fabs(bars.ground_m - bars.crank_m) - std::fabs(bars.coupler_m - bars.rocker_m);
  const double shortest = std::min({bars.crank_m, bars.coupler_m, bars.rocker_m, bars.ground_m});
  return std::min({outside, inside, shortest});
}

}  // namespace gdtslam::calib

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

template <auto Part, auto Value>
double& of_model(Setup& setup, std::size_t /*surface*/) {
  return setup.model.*Part.*Value;
}
template <auto Value>
double& of_surface(Setup& setup, std::size_t surface) {
  return setup.surfaces[surface].*Value;
}
double& offset_of_model(Setup& setup, std::size_t /*surface*/) { return setup.model.elevation_offset_rad; }

constexpr ParameterKind kCrank{"crank", of_model<&SweepModel::bars, &FourBar::crank_m>,
                               &SurfaceMiss::elevation_by_crank, Effect::kElevation};
constexpr ParameterKind kCoupler{"coupler", of_model<&SweepModel::bars, &FourBar::coupler_m>,
                                 &SurfaceMiss::elevation_by_coupler, Effect::kElevation};
constexpr ParameterKind kRocker{"rocker", of_model<&SweepModel::bars, &FourBar::rocker_m>,
                                &SurfaceMiss::elevation_by_rocker, Effect::kElevation};
constexpr ParameterKind kGround{"ground", of_model<&SweepModel::bars, &FourBar::ground_m>,
                                &SurfaceMiss::elevation_by_ground, Effect::kElevation};
constexpr ParameterKind kZero{"zero", of_model<&SweepModel::encoder, &CrankEncoder::zero_rad>,
                              &SurfaceMiss::elevation_by_zero, Effect::kElevation};
constexpr ParameterKind kOffset{"offset", offset_of_model, &SurfaceMiss::elevation_by_offset, Effect::kElevation};
constexpr ParameterKind kLeverForward{"lever.forward", of_model<&SweepModel::mount, &NoddingMount::lever_forward_m>,
                                      &SurfaceMiss::by_lever_forward, Effect::kMiss};
constexpr ParameterKind kLeverUp{"lever.up", of_model<&SweepModel::mount, &NoddingMount::lever_up_m>,
                                 &SurfaceMiss::by_lever_up, Effect::kMiss};
constexpr ParameterKind kRoll{"sensor.roll", of_model<&SweepModel::mount, &NoddingMount::sensor_roll_rad>,
                              &SurfaceMiss::by_roll, Effect::kMiss};
constexpr ParameterKind kYaw{"sensor.yaw", of_model<&SweepModel::mount, &NoddingMount::sensor_yaw_rad>,
                             &SurfaceMiss::by_yaw, Effect::kMiss};
constexpr ParameterKind kDistance{"distance.", of_surface<&CalibrationSurface::distance_m>, &SurfaceMiss::by_distance,
                                  Effect::kMissOfItsSurface};
constexpr ParameterKind kHeading{"heading.", of_surface<&CalibrationSurface::heading_rad>, &SurfaceMiss::by_heading,
                                 Effect::kMissOfItsSurface};

struct Family {
  std::string unit;
  double prior = 0.0;          ///< from the options, 0 for none
  double default_scale = 1.0;  ///< size of a step of 1 without a prior
  double bound = 0.0;
};

class ParameterList {
 public:
  explicit ParameterList(Setup start) : start_(std::move(start)) {}
  void add(const ParameterKind& kind, const Family& family, std::size_t surface = 0, const std::string& of = "") {
    Parameter parameter{.kind = &kind,
                        .surface = surface,
                        .name = kind.name + of,
                        .unit = family.unit,
                        .scale = family.prior > 0.0 ? family.prior : family.default_scale,
                        .prior_sigma = family.prior,
                        .bound = family.bound};
    parameter.start = kind.value(start_, surface);
    list.push_back(std::move(parameter));
  }
  std::vector<Parameter> list;

 private:
  Setup start_;
};

void check(const char* name, double value, double least, double most, std::vector<std::string>& faults) {
  if (value >= least && value <= most) return;
  faults.push_back(std::string(name) + " = " + std::to_string(value) + " must be " + std::to_string(least) + " to " +
                   std::to_string(most));
}

}  // namespace

CalibrationOptions CalibrationOptions::without_priors() const {
  CalibrationOptions options = *this;
  options.bar_prior_m = options.zero_prior_rad = options.offset_prior_rad = options.distance_prior_m = 0.0;
  options.lever_prior_m = options.angle_prior_rad = 0.0;
  return options;
}

std::vector<std::string> validate(const CalibrationOptions& options) {
  std::vector<std::string> faults;
  check("bar_bound_m", options.bar_bound_m, 1e-6, 0.1, faults);
  check("bar_prior_m", options.bar_prior_m, 0.0, 0.1, faults);
  check("zero_prior_rad", options.zero_prior_rad, 0.0, kTwoPi, faults);
  check("offset_prior_rad", options.offset_prior_rad, 0.0, kTwoPi, faults);
  check("distance_prior_m", options.distance_prior_m, 0.0, 100.0, faults);
  check("lever_prior_m", options.lever_prior_m, 0.0, 1.0, faults);
  check("angle_prior_rad", options.angle_prior_rad, 0.0, kTwoPi, faults);
  check("huber_sigmas", options.huber_sigmas, 0.1, 1000.0, faults);
  check("max_elevation_rad", options.max_elevation_rad, rad_from_deg(5.0), rad_from_deg(89.0), faults);
  return faults;
}

std::vector<Parameter> make_parameters(const Setup& start, const CalibrationOptions& options) {
  const CalibrationOptions defaults;
  const Family bar{"m", options.bar_prior_m, defaults.bar_prior_m, options.bar_bound_m};
  const Family zero{"rad", options.search_zero ? 0.0 : options.zero_prior_rad, defaults.zero_prior_rad, kPi};
  const Family offset{"rad", options.offset_prior_rad, defaults.offset_prior_rad, kOffsetBound_rad};
  const Family lever{"m", options.lever_prior_m, defaults.lever_prior_m, kLeverBound_m};
  const Family angle{"rad", options.angle_prior_rad, defaults.angle_prior_rad, kAngleBound_rad};
  const Family distance{"m", options.distance_prior_m, defaults.distance_prior_m, kDistanceBound_m};
  ParameterList parameters(start);
  for (const ParameterKind* kind : {&kCrank, &kCoupler, &kRocker, &kGround}) parameters.add(*kind, bar);
  parameters.add(kZero, zero);
  parameters.add(kOffset, offset);
  if (options.free_lever) {
    parameters.add(kLeverForward, lever);
    parameters.add(kLeverUp, lever);
  }
  if (options.free_sensor_angles) {
    parameters.add(kRoll, angle);
    parameters.add(kYaw, angle);
  }
  for (std::size_t k = 0; k < start.surfaces.size(); ++k) {
    const CalibrationSurface& surface = start.surfaces[k];
    if (!surface.distance_known) parameters.add(kDistance, distance, k, surface.name);
    if (!surface.heading_known && surface.kind == SurfaceKind::kWall) parameters.add(kHeading, angle, k, surface.name);
  }
  return std::move(parameters.list);
}

Setup setup_at(const Setup& start, std::span<const Parameter> parameters, std::span<const double> x) {
  Setup setup = start;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& parameter = parameters[i];
    parameter.kind->value(setup, parameter.surface) = parameter.start + parameter.scale * x[i];
  }
  return setup;
}

double elevation_derivative(const SurfaceMiss& miss, const Parameter& parameter) {
  const ParameterKind& kind = *parameter.kind;
  return kind.effect == Effect::kElevation ? parameter.scale * miss.*kind.by : 0.0;
}

double derivative(const SurfaceMiss& miss, const Parameter& parameter, std::uint32_t observed_surface) {
  const ParameterKind& kind = *parameter.kind;
  if (kind.effect == Effect::kElevation) return miss.by_elevation * elevation_derivative(miss, parameter);
  if (kind.effect == Effect::kMissOfItsSurface && parameter.surface != observed_surface) return 0.0;
  return parameter.scale * miss.*kind.by;
}

double closing_room_m(const FourBar& bars) {
  const double outside = bars.coupler_m + bars.rocker_m - (bars.ground_m + bars.crank_m);
  const double inside = std::fabs(bars.ground_m - bars.crank_m) - std::fabs(bars.coupler_m - bars.rocker_m);
  const double shortest = std::min({bars.crank_m, bars.coupler_m, bars.rocker_m, bars.ground_m});
  return std::min({outside, inside, shortest});
}

}  // namespace gdtslam::calib

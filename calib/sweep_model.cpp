#include "gdtslam/calib/sweep_model.hpp"

#include <algorithm>
#include <cmath>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam::calib {
namespace {

constexpr std::uint32_t kTableBits = 15;
// Of a scanner with the paper's 961 beams of 0.25 deg and 20 m; the paper states none. The simulator's hokuyo-961 has
// it.
constexpr double kPaperMirrorRate_hz = 40.0;

// The same angle in [-pi, pi): an elevation of half a turn counts as looking back from below.
double wrap_elevation(double angle_rad) {
  const double wrapped_rad = wrap_angle(angle_rad);
  return wrapped_rad >= kPi ? -kPi : wrapped_rad;
}

// Makes the elevations continuous, then shifts them by whole turns so that the middle of their range lies in [-pi, pi):
// neighbours can be interpolated and even a rocker that turns fully stays within 2 pi.
void unwrap(std::vector<double>& elevations_rad) {
  for (std::size_t i = 1; i < elevations_rad.size(); ++i) {
    elevations_rad[i] = elevations_rad[i - 1] + wrap_angle(elevations_rad[i] - elevations_rad[i - 1]);
  }
  const auto [low, high] = std::minmax_element(elevations_rad.begin(), elevations_rad.end());
  const double shift_rad = kTwoPi * std::floor(((*low + *high) / 2.0 + kPi) / kTwoPi);
  if (shift_rad == 0.0) return;
  for (double& elevation_rad : elevations_rad) elevation_rad -= shift_rad;
}

// How far the table's line between two entries lies from the closed form at most: an eighth of the largest second
// difference, which is that of a parabola, and the rounding of the entries to float32 on a device.
double table_error_rad(const std::vector<double>& values_rad) {
  constexpr double kMargin = 1.02;  // the second differences are taken at the entries only
  const double float_unit = std::ldexp(1.0, -24);
  double bend_rad = 0.0;
  double largest_rad = 0.0;
  for (std::size_t i = 0; i + 1 < values_rad.size(); ++i) {
    // The table is periodic but for whole turns; the entry before the first is the last but one.
    const double before_rad = i > 0 ? values_rad[i] - values_rad[i - 1]
                                    : values_rad[values_rad.size() - 1] - values_rad[values_rad.size() - 2];
    bend_rad = std::max(bend_rad, std::fabs((values_rad[i + 1] - values_rad[i]) - before_rad));
    largest_rad = std::max(largest_rad, std::fabs(values_rad[i]));
  }
  return kMargin * bend_rad / 8.0 + float_unit * largest_rad;
}

double steepest_step_rad(const std::vector<double>& values_rad) {
  double step_rad = 0.0;
  for (std::size_t i = 0; i + 1 < values_rad.size(); ++i) {
    step_rad = std::max(step_rad, std::fabs(values_rad[i + 1] - values_rad[i]));
  }
  return step_rad;
}

// The broken inequality where there is one, else where the loop opens.
std::string does_not_turn_fully(const SweepModel& model, double crank_rad) {
  const std::string whose = model.name.empty() ? std::string() : "linkage '" + model.name + "': ";
  try {
    static_cast<void>(analyse(model.bars, model.assembly));
  } catch (const ConfigError& error) {
    return whose + error.what();
  }
  const double crank_deg = std::round(deg_from_rad(wrap_angle(crank_rad)) * 10.0) / 10.0;
  return whose + "the loop does not close at a crank angle of " + format_quantity(crank_deg, Unit::kNone) +
         " deg; change the bars' lengths so that the crank turns fully";
}

}  // namespace

SweepModel sweep_model_of(const FourBar& bars, Assembly assembly) {
  SweepModel model;
  model.bars = bars;
  model.assembly = assembly;
  const CrankRockerReport report = analyse(bars, assembly);
  model.encoder.zero_rad = report.lowest.crank_rad;
  model.encoder.direction = report.lift_direction;
  model.elevation_sign = wrap_angle(report.highest.rocker_rad - report.lowest.rocker_rad) > 0.0 ? 1 : -1;
  model.elevation_offset_rad = -model.elevation_sign * report.lowest.rocker_rad;
  return model;
}

SweepModel sweep_model_of_preset(std::string_view name) {
  const LinkagePreset& preset = linkage_preset(name);
  SweepModel model = sweep_model_of(preset.bars, Assembly::kOpen);
  model.name = std::string(preset.name);
  model.mirror_rate_hz = kPaperMirrorRate_hz;
  return model;
}

std::optional<double> elevation_rad(const SweepModel& model, double crank_rad) {
  const std::optional<LinkagePose> pose = solve(model.bars, model.assembly, crank_rad);
  if (!pose) return std::nullopt;
  return wrap_elevation(model.elevation_sign * pose->rocker_rad + model.elevation_offset_rad);
}

std::optional<double> elevation_rate(const SweepModel& model, double crank_rad) {
  const std::optional<LinkageMotion> rates = motion(model.bars, model.assembly, crank_rad);
  if (!rates) return std::nullopt;
  return model.elevation_sign * rates->rocker_rate;
}

ElevationTable elevation_table(const SweepModel& model, std::uint32_t bits) {
  constexpr std::uint32_t kMostBits = 20;
  if (bits > kMostBits) {
    throw ConfigError("an elevation table has at most 2^20 steps, not 2^" + std::to_string(bits));
  }
  const std::size_t steps = std::size_t{1} << bits;
  std::vector<double> elevations_rad(steps + 1);
  for (std::size_t i = 0; i <= steps; ++i) {
    const double turn = static_cast<double>(i) / static_cast<double>(steps);
    const double phi_rad = crank_rad(model.encoder, turn * static_cast<double>(model.encoder.ticks_per_turn));
    const std::optional<double> elevation = elevation_rad(model, phi_rad);
    if (!elevation) {
      throw ConfigError(does_not_turn_fully(model, phi_rad));
    }
    elevations_rad[i] = *elevation;
  }
  unwrap(elevations_rad);
  return ElevationTable(std::move(elevations_rad));
}

BeamTiming beam_timing(const SweepModel& model, std::size_t beams, double bearing_step_rad) {
  if (!(model.mirror_rate_hz > 0.0) || beams == 0) return {};
  BeamTiming timing;
  timing.step_s = std::fabs(bearing_step_rad) / kTwoPi / model.mirror_rate_hz;
  timing.first_s = -model.stamp_share * static_cast<double>(beams - 1) * timing.step_s;
  return timing;
}

double quantisation_bound_m(const SweepModel& model, double range_m, double range_resolution_m) {
  const ElevationTable table = elevation_table(model, kTableBits);
  const double steps = static_cast<double>(table.values_rad().size() - 1);
  const double ticks_in_steps = steps / static_cast<double>(model.encoder.ticks_per_turn);
  // The table is linear between its entries, so a tick moves it by its steepest step's share at most.
  const double elevation_error_rad =
      steepest_step_rad(table.values_rad()) * ticks_in_steps + table_error_rad(table.values_rad());
  const double lever_m = std::sqrt(model.mount.lever_forward_m * model.mount.lever_forward_m +
                                   model.mount.lever_up_m * model.mount.lever_up_m);
  return elevation_error_rad * (range_m + lever_m) + range_resolution_m;
}

}  // namespace gdtslam::calib

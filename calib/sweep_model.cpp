#include "gdtslam/calib/sweep_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam::calib {
namespace {

constexpr std::uint32_t kTableBits = 15;
// Rate of a scanner with the paper's 961 beams of 0.25 deg and 20 m, as in the simulator's hokuyo-961; the paper states
// none.
constexpr double kPaperMirrorRate_hz = 40.0;

// The same angle in [-pi, pi): an elevation of half a turn counts as looking back from below.
double wrap_elevation(double angle_rad) {
  const double wrapped_rad = wrap_angle(angle_rad);
  return wrapped_rad >= kPi ? -kPi : wrapped_rad;
}

// Makes the elevations continuous, then shifts them by whole turns so that the middle of their range is in [-pi, pi).
// Then neighbours can be interpolated, and even a fully turning rocker stays within 2 pi.
void unwrap(std::vector<double>& elevations_rad) {
  for (std::size_t i = 1; i < elevations_rad.size(); ++i) {
    elevations_rad[i] = elevations_rad[i - 1] + wrap_angle(elevations_rad[i] - elevations_rad[i - 1]);
  }
  const auto [low, high] = std::minmax_element(elevations_rad.begin(), elevations_rad.end());
  const double shift_rad = kTwoPi * std::floor(((*low + *high) / 2.0 + kPi) / kTwoPi);
  if (shift_rad == 0.0) return;
  for (double& elevation_rad : elevations_rad) elevation_rad -= shift_rad;
}

// Largest error of linear interpolation in the table: an eighth of the largest second difference (that of a parabola),
// plus the rounding of the entries to float32 on a device.
double table_error_rad(const std::vector<double>& values_rad) {
  constexpr double kMargin = 1.02;  // second differences are taken only at the entries
  const double float_unit = std::ldexp(1.0, -24);
  double bend_rad = 0.0;
  double largest_rad = 0.0;
  for (std::size_t i = 0; i + 1 < values_rad.size(); ++i) {
    // The table is periodic up to whole turns; the entry before the first is the last but one.
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

// The violated inequality if there is one, else where the loop opens.
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

using Faults = std::vector<std::string>;

constexpr std::int64_t kMostTicks = std::int64_t{1} << 30;

std::string metres(double value_m) { return format_quantity(value_m, Unit::kMetre); }
std::string number(double value) { return format_quantity(value, Unit::kNone); }

void check_bar(const char* name, double length_m, Faults& faults) {
  const std::string is = std::string("bars.") + name + " = " + metres(length_m);
  if (!(length_m > 0.0) || !std::isfinite(length_m)) {
    faults.push_back(is + " must be a length above zero");
  } else if (length_m > kMostBar_m) {
    const bool fits_cm = length_m * 0.01 <= kMostBar_m;
    faults.push_back(is + " is longer than 1 m; did you mean " + number(length_m) + (fits_cm ? " cm" : " mm") + "?");
  } else if (length_m < kLeastBar_m) {
    const double meant_m = std::round(length_m * 100.0 * 1e9) / 1e9;
    faults.push_back(is + " is shorter than 1 mm; " +
                     (meant_m >= kLeastBar_m ? "did you mean " + number(meant_m) + " m? " : std::string()) +
                     "check its unit");
  }
}

void check_range(const std::string& name, double value, double least, double most, const char* unit, Faults& faults) {
  if (value >= least && value <= most) return;
  faults.push_back(name + " = " + number(value) + unit + " must be " + number(least) + " to " + number(most) + unit);
}

void check_sign(const char* name, int value, Faults& faults) {
  if (value == 1 || value == -1) return;
  faults.push_back(std::string(name) + " = " + std::to_string(value) + " must be 1 or -1");
}

void check_mount(const NoddingMount& mount, Faults& faults) {
  check_range("mount.height", mount.height_m, -10.0, 100.0, " m", faults);
  check_range("mount.lever_forward", mount.lever_forward_m, -1.0, 1.0, " m", faults);
  check_range("mount.lever_up", mount.lever_up_m, -1.0, 1.0, " m", faults);
  check_range("mount.roll", mount.sensor_roll_rad, -kTwoPi, kTwoPi, " rad", faults);
  check_range("mount.yaw", mount.sensor_yaw_rad, -kTwoPi, kTwoPi, " rad", faults);
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

double crank_rad(const CrankEncoder& encoder, double ticks) {
  return encoder.zero_rad + encoder.direction * (2.0 * kPi * ticks / static_cast<double>(encoder.ticks_per_turn));
}

Phase phase_of_ticks(const CrankEncoder& encoder, double ticks) {
  return phase_of_turns(ticks / static_cast<double>(encoder.ticks_per_turn));
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

BeamTiming beam_timing(const SweepModel& model, const LaserScan& scan) {
  return stated_timing(scan).value_or(beam_timing(model, scan.ranges_m.size(), scan.bearing_step_rad));
}

double quantisation_bound_m(const SweepModel& model, double range_m, double range_resolution_m) {
  const ElevationTable table = elevation_table(model, kTableBits);
  const double steps = static_cast<double>(table.values_rad().size() - 1);
  const double ticks_in_steps = steps / static_cast<double>(model.encoder.ticks_per_turn);
  // The table is linear between its entries, so a tick changes it at most by its share of the steepest step.
  const double elevation_error_rad =
      steepest_step_rad(table.values_rad()) * ticks_in_steps + table_error_rad(table.values_rad());
  const double lever_m = std::sqrt(model.mount.lever_forward_m * model.mount.lever_forward_m +
                                   model.mount.lever_up_m * model.mount.lever_up_m);
  return elevation_error_rad * (range_m + lever_m) + range_resolution_m;
}

Faults validate(const SweepModel& model) {
  Faults faults;
  const FourBar& bars = model.bars;
  const std::array<std::pair<const char*, double>, 4> lengths{
      {{"crank", bars.crank_m}, {"coupler", bars.coupler_m}, {"rocker", bars.rocker_m}, {"ground", bars.ground_m}}};
  for (const auto& [name, length_m] : lengths) check_bar(name, length_m, faults);
  // A loop with lengths in two units does not close either; then the unit must be corrected.
  if (faults.empty()) {
    for (const std::string& violation : violations(bars)) faults.push_back("bars: " + violation);
  }
  const CrankEncoder& encoder = model.encoder;
  if (encoder.ticks_per_turn < 1 || encoder.ticks_per_turn > kMostTicks) {
    faults.push_back("encoder.ticks_per_turn = " + std::to_string(encoder.ticks_per_turn) + " must be 1 to " +
                     std::to_string(kMostTicks));
  }
  check_range("encoder.zero", encoder.zero_rad, -kTwoPi, kTwoPi, " rad", faults);
  check_sign("encoder.direction", encoder.direction, faults);
  check_sign("elevation.sign", model.elevation_sign, faults);
  check_range("elevation.offset", model.elevation_offset_rad, -2.0 * kTwoPi, 2.0 * kTwoPi, " rad", faults);
  check_mount(model.mount, faults);
  check_range("laser.mirror_rate", model.mirror_rate_hz, 0.0, 1000.0, " Hz", faults);
  check_range("laser.stamp", model.stamp_share, 0.0, 1.0, "", faults);
  return faults;
}

}  // namespace gdtslam::calib

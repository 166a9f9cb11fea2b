#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam::calib {
namespace {

using Faults = std::vector<std::string>;

constexpr double kLeastBar_m = 0.001;
constexpr double kMostBar_m = 1.0;
constexpr std::int64_t kMostTicks = std::int64_t{1} << 30;

std::string metres(double value_m) { return format_quantity(value_m, Unit::kMetre); }
std::string number(double value) { return format_quantity(value, Unit::kNone); }

// A bar of a nodding mount is a hand's length; what is far off was most likely written in another unit.
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

Faults validate(const SweepModel& model) {
  Faults faults;
  const FourBar& bars = model.bars;
  const std::array<std::pair<const char*, double>, 4> lengths{
      {{"crank", bars.crank_m}, {"coupler", bars.coupler_m}, {"rocker", bars.rocker_m}, {"ground", bars.ground_m}}};
  for (const auto& [name, length_m] : lengths) check_bar(name, length_m, faults);
  // A loop of lengths in two units does not close either; the unit is what to mend.
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

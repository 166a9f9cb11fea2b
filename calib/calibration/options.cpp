#include <cmath>
#include <string>

#include "gdtslam/calib/calibration.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

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

// L1..L7 under the readings of the figure: paper-a (crank, coupler, rocker, ground) = L2, L4, L5, L3; paper-b L2, L4,
// L5, L6; paper-c L2, L4, L6, L5.
std::vector<PaperBar> paper_bars(const std::string& model_name) {
  if (!model_name.starts_with("paper-") || model_name.size() < 7) return {};
  std::vector<PaperBar> bars(7);
  for (std::size_t k = 0; k < bars.size(); ++k) bars[k].name = "delta" + std::to_string(k + 1);
  bars[1].place = "crank";
  bars[3].place = "coupler";
  switch (model_name[6]) {
    case 'a':
      bars[4].place = "rocker";
      bars[2].place = "ground";
      break;
    case 'b':
      bars[4].place = "rocker";
      bars[5].place = "ground";
      break;
    case 'c':
      bars[5].place = "rocker";
      bars[4].place = "ground";
      break;
    default:
      return {};
  }
  return bars;
}

}  // namespace gdtslam::calib

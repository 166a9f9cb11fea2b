#include <cmath>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {

double crank_rad(const CrankEncoder& encoder, double ticks) {
  return encoder.zero_rad + encoder.direction * (2.0 * kPi * ticks / static_cast<double>(encoder.ticks_per_turn));
}

Phase phase_of_ticks(const CrankEncoder& encoder, double ticks) {
  return phase_of_turns(ticks / static_cast<double>(encoder.ticks_per_turn));
}

}  // namespace gdtslam::calib

// The paper's calibration protocol, simulated without the code under test but for the linkage itself: a wall, a crank
// that stops each 1.8 degrees for two turns, 250 ranges of the forward beam a stop.
#pragma once

#include <cstdint>
#include <vector>

#include "gdtslam/calib/calibration.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::calib {

struct Protocol {
  std::string preset = "paper-b";
  double wall_m = 2.0;
  double sigma_m = 0.01;
  double bar_error_m = 0.003;
  double zero_error_rad = 0.0349;
  double offset_error_rad = 0.0873;
  double wall_error_m = 0.05;
  double lever_error_m = 0.0;  ///< 0.02 where the lever is not known
  double max_range_m = 20.0;
  int stops_per_turn = 200;
  int turns = 2;
  int ranges_per_stop = 250;
};

/// One mount drawn at random, what it measures, and what the calibration is told.
struct Experiment {
  SweepModel truth;
  SweepModel start;
  std::vector<CalibrationSurface> surfaces;
  std::vector<RangeObservation> observations;
  double wall_m = 0.0;
};

/// A loop that closes all around, drawn within the errors.
Experiment draw_experiment(const Protocol& protocol, Random& random);
/// The same mount measured again.
std::vector<RangeObservation> measure(const Protocol& protocol, const SweepModel& truth, Random& random);
/// RMS of the difference of the elevations at the ticks where the true one is within the limit, radians.
double elevation_error_rad(const SweepModel& truth, const SweepModel& model, double up_to_rad);

}  // namespace gdtslam::calib

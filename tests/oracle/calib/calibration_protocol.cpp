#include "calibration_protocol.hpp"

#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

bool closes_all_around(const FourBar& bars) {
  for (int k = 0; k < 3600; ++k) {
    if (!solve(bars, Assembly::kOpen, kTwoPi * k / 3600.0)) return false;
  }
  return true;
}

SweepModel draw_truth(const Protocol& protocol, const SweepModel& nominal, Random& random) {
  SweepModel truth = nominal;
  do {
    for (double FourBar::*bar : {&FourBar::crank_m, &FourBar::coupler_m, &FourBar::rocker_m, &FourBar::ground_m}) {
      truth.bars.*bar = nominal.bars.*bar + random.uniform(-protocol.bar_error_m, protocol.bar_error_m);
    }
  } while (!closes_all_around(truth.bars));
  truth.encoder.zero_rad += random.normal(0.0, protocol.zero_error_rad);
  truth.elevation_offset_rad += random.normal(0.0, protocol.offset_error_rad);
  truth.mount.lever_forward_m += random.normal(0.0, protocol.lever_error_m);
  truth.mount.lever_up_m += random.normal(0.0, protocol.lever_error_m);
  return truth;
}

}  // namespace

std::vector<RangeObservation> measure(const Protocol& protocol, const SweepModel& truth, Random& random) {
  std::vector<RangeObservation> observations;
  const double ticks_per_stop =
      static_cast<double>(truth.encoder.ticks_per_turn) / static_cast<double>(protocol.stops_per_turn);
  for (int stop = 0; stop < protocol.turns * protocol.stops_per_turn; ++stop) {
    const double ticks = ticks_per_stop * (stop % protocol.stops_per_turn);
    const double elevation = *elevation_rad(truth, crank_rad(truth.encoder, ticks));
    // (A1) with a lever arm: r = (d - a cos + b sin) / cos.
    const double ahead =
        truth.mount.lever_forward_m * std::cos(elevation) - truth.mount.lever_up_m * std::sin(elevation);
    const double range = (protocol.wall_m - ahead) / std::cos(elevation);
    if (std::cos(elevation) <= 0.0 || range > protocol.max_range_m) continue;
    double sum = 0.0;
    for (int k = 0; k < protocol.ranges_per_stop; ++k) sum += random.normal(range, protocol.sigma_m);
    observations.push_back({.ticks = ticks,
                            .range_m = sum / protocol.ranges_per_stop,
                            .sigma_m = protocol.sigma_m / std::sqrt(static_cast<double>(protocol.ranges_per_stop)),
                            .count = static_cast<std::uint32_t>(protocol.ranges_per_stop)});
  }
  return observations;
}

Experiment draw_experiment(const Protocol& protocol, Random& random) {
  Experiment experiment;
  experiment.start = sweep_model_of_preset(protocol.preset);
  experiment.truth = draw_truth(protocol, experiment.start, random);
  experiment.wall_m = protocol.wall_m;
  experiment.surfaces = {{.name = "wall", .distance_m = protocol.wall_m + random.normal(0.0, protocol.wall_error_m)}};
  experiment.observations = measure(protocol, experiment.truth, random);
  return experiment;
}

double elevation_error_rad(const SweepModel& truth, const SweepModel& model, double up_to_rad) {
  double sum = 0.0;
  int count = 0;
  for (int k = 0; k < 2000; ++k) {
    const double ticks = static_cast<double>(truth.encoder.ticks_per_turn) * k / 2000.0;
    const std::optional<double> right = elevation_rad(truth, crank_rad(truth.encoder, ticks));
    if (std::fabs(*right) > up_to_rad) continue;
    const std::optional<double> found = elevation_rad(model, crank_rad(model.encoder, ticks));
    const double error = found ? wrap_angle(*found - *right) : kPi;
    sum += error * error;
    ++count;
  }
  return std::sqrt(sum / count);
}

}  // namespace gdtslam::calib

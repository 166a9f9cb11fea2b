// A nodding mount that works while the robot drives: the crank's course, its encoder, and the pose of the laser at any
// time. Frame: map. Thread-safe but for CrankEncoderModel.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam::sim {

enum class NodMode : std::uint8_t {
  kContinuous,   ///< the crank turns evenly all the time
  kStopAndScan,  ///< the robot stands during a sweep and drives during none: the crank turns only while it stands
  kStepped,      ///< the crank stops each step_rad for stop_s (the paper's calibration protocol), robot standing
};

struct NoddingModel {
  calib::SweepModel truth;  ///< what the mount really is
  NodMode mode = NodMode::kContinuous;
  double crank_rate_hz = 0.2;              ///< turns of the crank a second
  double encoder_rate_hz = 100.0;          ///< messages a second
  bool quantise = true;                    ///< whole ticks
  double start_turns = 0.0;                ///< phase at time 0
  double step_rad = 0.031415926535897934;  ///< 1.8 deg: 100 ticks of 20,000
  double stop_s = 5.0;
};

std::vector<std::string> validate(const NoddingModel& model);

/// Turns of the crank from tick 0 since the log's begin, a monotone function of time.
double crank_turns(const NoddingModel& model, double time_s);
Encoder encoder_message(const NoddingModel& model, double time_s);
/// The true elevation. The linkage closes all around (validate()).
double true_elevation_rad(const NoddingModel& model, double time_s);

}  // namespace gdtslam::sim

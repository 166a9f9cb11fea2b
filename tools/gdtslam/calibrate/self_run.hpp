// What `gdtslam calibrate --self` does: maps the logs with the start's linkage for the robot's poses, then makes the
// strokes of the laser agree with each other. One run belongs to one thread.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/calibration/self_calibration.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {

struct SelfCalibrateJob {
  std::vector<std::string> logs;
  calib::SweepModel start;
  ReadOptions read;
  calib::SelfCalibrationOptions options;
};

struct SelfCalibrateOutcome {
  calib::SweepModel start;
  calib::SelfCalibrationResult result;
  std::uint64_t scans = 0;
  std::uint64_t beams = 0;  ///< compared, a part of all spread evenly
  std::uint32_t strokes = 0;
  std::vector<LogReader::Warning> warnings;  ///< of the readers and of the encoder
  std::string distrust;                      ///< why the result is not to be used; empty where it is
};

/// Throws InputError, FileError, ConfigError.
SelfCalibrateOutcome run_self_calibration(const SelfCalibrateJob& job, const std::function<void(double)>& progress,
                                          const std::function<bool()>& stop);

}  // namespace gdtslam

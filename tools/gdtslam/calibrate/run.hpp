// What `gdtslam calibrate` does: reads logs of a standing scanner, finds which surface each range belongs to,
// calibrates. One run belongs to one thread.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gdtslam/calib/calibration.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/io/log.hpp"
#include "stops.hpp"

namespace gdtslam {

struct CalibrateJob {
  std::vector<std::string> logs;
  calib::SweepModel start;
  std::string surfaces = "wall";  ///< as on the command line: "wall=2m@30deg,ceiling"
  bool distances_known = false;
  bool headings_free = false;
  double sector_rad = 0.0;  ///< 0: the forward beam
  double sigma_m = 0.0;     ///< of one range; 0: from the scatter
  ReadOptions read;
  calib::CalibrationOptions options;
};

struct CalibrateOutcome {
  calib::SweepModel start;
  std::vector<calib::CalibrationSurface> start_surfaces;
  calib::CalibrationResult result;
  std::vector<calib::RangeObservation> observations;  ///< with their surfaces, all elevations
  double max_elevation_rad = 0.0;
  std::size_t unassigned = 0;  ///< averages that belong to no surface
  StopStatistics statistics;
  std::vector<LogReader::Warning> warnings;  ///< of the readers and of the encoder
  std::string distrust;                      ///< why the result is not to be used; empty where it is
};

/// Throws UsageError for surfaces that make no sense before any log is read; InputError, FileError or ConfigError.
CalibrateOutcome run_calibration(const CalibrateJob& job, const std::function<void(double)>& progress,
                                 const std::function<bool()>& stop);

/// Figure A of the paper: measured and modelled ranges over the encoder, and what is left of them over the elevation,
/// before and after.
Canvas calibration_figure(const CalibrateOutcome& outcome);

}  // namespace gdtslam

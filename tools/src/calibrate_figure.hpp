// Figure A of the paper for a calibration: measured and modelled ranges over the encoder, and what is left of them over
// the elevation, before and after. SVG. Thread-safe.
#pragma once

#include <string>

#include "calibrate_run.hpp"

namespace gdtslam {

std::string calibration_figure(const CalibrateOutcome& outcome);

}  // namespace gdtslam

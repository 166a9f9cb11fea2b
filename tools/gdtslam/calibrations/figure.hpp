// Figure A of the paper for a calibration: measured and modelled ranges over the encoder, and what is left of them over
// the elevation, before and after. Thread-safe.
#pragma once

#include "gdtslam/drawing/canvas.hpp"
#include "run.hpp"

namespace gdtslam {

Canvas calibration_figure(const CalibrateOutcome& outcome);

}  // namespace gdtslam

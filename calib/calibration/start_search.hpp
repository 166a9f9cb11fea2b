// Where to start when the encoder's zero is not known, as for the other assembly. O(crank angles x observations).
#pragma once

#include <vector>

#include "parameters.hpp"

namespace gdtslam::calib {

/// The same bars assembled the other way, so that the elevation covers the same range: the course of the elevation over
/// a turn is that of the start run backwards.
SweepModel other_assembly(const SweepModel& model);
/// The model with the encoder's zero that makes the observations miss their surfaces least.
SweepModel best_zero(const Setup& setup, const SweepModel& model, const std::vector<RangeObservation>& observations,
                     const CalibrationOptions& options);

}  // namespace gdtslam::calib

// The surfaces of `gdtslam calibrate --surfaces`, and a guess of where they are. Thread-safe.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/calib/calibration.hpp"

namespace gdtslam {

/// From "wall", "wall=2m", "wall=2m@30deg,ceiling=2.2m,floor": each with a distance from the nodding axis where one is
/// given, else with one guessed from the ranges under the start's elevations. Throws UsageError for text that makes no
/// sense, InputError where no range tells a distance.
std::vector<calib::CalibrationSurface> surfaces_of(const std::string& text, const calib::SweepModel& start,
                                                   const std::vector<calib::RangeObservation>& ranges);

}  // namespace gdtslam

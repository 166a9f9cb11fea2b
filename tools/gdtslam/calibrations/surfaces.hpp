// The surfaces of `gdtslam calibrate --surfaces`, and a guess of where they are. Thread-safe.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/calib/calibration.hpp"

namespace gdtslam {

/// A surface as it was named, with its distance from the nodding axis where one was given.
struct NamedSurface {
  calib::CalibrationSurface surface;
  bool has_distance = false;
};

/// From "wall", "wall=2m", "wall=2m@30deg,ceiling=2.2m,floor". Throws UsageError for text that makes no sense.
std::vector<NamedSurface> named_surfaces(const std::string& text);

/// Those without a distance get one guessed from the ranges under the start's elevations. Throws InputError where no
/// range tells a distance.
std::vector<calib::CalibrationSurface> placed_surfaces(const std::vector<NamedSurface>& named,
                                                       const calib::SweepModel& start,
                                                       const std::vector<calib::RangeObservation>& ranges);

}  // namespace gdtslam

// The dead points of a crank-rocker in closed form. Frame and units of four_bar.hpp. Thread-safe, constant time.
#pragma once

#include "gdtslam/calib/four_bar.hpp"

namespace gdtslam::calib {

/// Where the rocker of a crank-rocker turns back, with crank and coupler stretched or folded over each other.
DeadPoint dead_point(const FourBar& bars, Assembly assembly, bool is_stretched);

}  // namespace gdtslam::calib

// Where a crank-rocker's rocker turns back. Only for lengths that are a crank-rocker. Thread-safe, constant time.
#pragma once

#include "gdtslam/calib/four_bar.hpp"

namespace gdtslam::calib {

/// With crank and coupler in line: stretched, or folded over each other.
DeadPoint dead_point(const FourBar& bars, Assembly assembly, bool is_stretched);

}  // namespace gdtslam::calib

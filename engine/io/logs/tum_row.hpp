// A row of a trajectory in space, the format of trajectory_file.hpp.
#pragma once

#include <string>

#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

/// One row, with its end of line. Throws Error if the pose is not finite.
std::string tum_row(double stamp_s, const Pose3& T_map_base);

}  // namespace gdtslam

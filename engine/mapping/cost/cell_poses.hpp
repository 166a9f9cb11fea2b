// Poses in metres from poses in cells around an anchor. Thread-safe.
#pragma once

#include "engine/mapping/cost/objective.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

inline Pose2 pose_in_metres(const CellPose& pose, CellIndex anchor, double resolution_m) {
  return {(static_cast<double>(pose.x) + anchor.x) * resolution_m,
          (static_cast<double>(pose.y) + anchor.y) * resolution_m, wrap_angle(static_cast<double>(pose.theta))};
}

}  // namespace gdtslam

// Values of a field under each point of a scan at a pose: the nearest cell, any value. On the host only.
//
// Arithmetic: u, v, s and c as in pose_cost; the cell is floor(u) + anchor_x, floor(v) + anchor_y, as float32, clamped
// to [0, width - 1] x [0, height - 1]. Unlike pose_cost, u and v are not quantised first. No coordinate may be NaN.
#pragma once

#include "engine/compute/kernels/pose_slope/pose_slope.hpp"

namespace gdtslam {

struct PointValues {
  using Params = PoseCost::Params;  ///< cap, interpolation and form do not matter
  using Pose = PoseSlope::Pose;
};

}  // namespace gdtslam

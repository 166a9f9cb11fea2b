// Values of a field under each point of a scan at a pose: the nearest cell, any value. On the host only.
//
// Arithmetic: u, v, s and c as in pose_cost; the cell is floor(u) + anchor_x, floor(v) + anchor_y, as float32, clamped
// to [0, width - 1] x [0, height - 1]. Unlike pose_cost, u and v are not quantised first. No coordinate may be NaN.
#pragma once

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"

namespace gdtslam {

struct PointValues {
  using Params = PoseCost::Params;  ///< cap, interpolation and form do not matter
  struct Pose {
    float x = 0.0F;
    float y = 0.0F;
    float theta = 0.0F;
  };
};

}  // namespace gdtslam

// The cost of a pose with its slope, for a Gauss-Newton step over (x, y, theta), summed over the scan's points. On the
// host only. Poses and points in cells, as in pose_cost.
//
// Arithmetic (docs/numerics.md), float32 without contraction, the same bits on every instruction set: u, v, s and c as
// in pose_cost; the field is bilinear between the centres of its cells, value and slopes from the four neighbours of
// (u - 1/2, v - 1/2); beyond the two outermost rows and columns, and wherever the value reaches the cap, the value is
// the cap and the slopes are 0. A value d counts as d^2 / (2 k) below k = `scale` and as d - k / 2 above [Huber1964];
// the weight of a point in the normal equations is 1 / max(d, k). Point i is added to lane i % kLanes; the lanes of a
// sum are added in order, as double.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"

namespace gdtslam {

struct PoseSlope {
  static constexpr std::uint32_t kLanes = 16;
  struct Params {
    PoseCost::Params grid;  ///< interpolation and form do not matter: bilinear, distance
    float scale = 256.0F;   ///< 1/256 cell, positive
  };
  struct Pose {
    float x = 0.0F;
    float y = 0.0F;
    float theta = 0.0F;
  };
  /// Robust cost (1/256 cell); its gradient along x, y (cells) and theta (radians); the curvatures xx, xy, xt, yy, yt,
  /// tt of the normal equations.
  static constexpr std::size_t kSums = 10;
  using Sums = std::array<double, kSums>;
};

}  // namespace gdtslam

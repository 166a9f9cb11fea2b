// The descent of a pose along the slope of the field: robust least squares over (x, y, theta) through narrowing gates.
// Poses and points in cells, as in pose_cost.
//
// Arithmetic (docs/numerics.md), float32 without contraction, the same bits on every instruction set: u, v, s and c as
// in pose_cost; the field is bilinear between the centres of its cells, value and slopes from the four neighbours of
// (u - 1/2, v - 1/2); beyond the two outermost rows and columns, and wherever the value reaches the cap, the value is
// the cap and the slopes are 0. With t = min(1, d / width) and q = 1 - t^2 a value d costs width^2 / (6 * 256) (1 -
// q^3) and weighs q^2 / 256 in the normal equations, the biweight [Beaton1974]: near 0 it costs d^2 / 512, beyond the
// width it does not count. Point i is added to lane i % kLanes; lane i + k is added to lane i for k = kLanes / 2,
// ..., 1. The prior, which is that of pose_lattice.hpp without the cut to integers, is added last.
#pragma once

#include <cstdint>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"
#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"

namespace gdtslam {

/// Descends from each pose, in place. A step solves (H + damping diag(H)) step = -gradient by LDL^T, whose reciprocals
/// are three steps of Newton from 0x7EF311C7 minus the bits. The damping [Levenberg1944, Marquardt1963] is 1e-4 at the
/// start of a width; after a step that does not lower the cost, which is undone, and after singular equations it is 1,
/// then four times as much each time: across a wall the field has no slope that fades, and undamped steps leap to and
/// fro over it. A width is done when a step is below the stop, kLoose times as large at all widths but the last, or the
/// damping exceeds 1000; the next one is `narrowing` times as large, at least last_width. `cost` of the result is the
/// last width's, rounded down. Extent: x = poses.
struct PoseDescent {
  static constexpr std::uint32_t kLanes = 64;
  static constexpr float kLoose = 8.0F;
  struct Params {
    PoseCost::Params grid;  ///< interpolation and form do not matter: bilinear, distance
    PriorParams prior;
    float width = 5120.0F;  ///< of the first gate, 1/256 cell, positive
    float narrowing = 0.5F;
    float last_width = 1280.0F;  ///< positive
    float stop_cells = 0.01F;    ///< stops when a step is smaller than this in x and y ...
    float stop_rad = 0.0002F;    ///< ... and than this in theta
    std::uint32_t max_evaluations = 40;
  };
};

}  // namespace gdtslam

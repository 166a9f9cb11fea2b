// The descent of a pose along the slope of the field: robust least squares over (x, y, theta) through narrowing gates.
// Poses and points in cells, as in pose_cost. docs/numerics.md, "Descent along the slope", has the order of all
// operations.
//
// float32 without contraction, the same bits on every instruction set and device. u and v as in pose_cost, less 1/2,
// not quantised; cell = floor + anchor in float32, clamped to [0, width-2] x [0, height-2]; a clamped coordinate has
// fraction 0. bottom = v00 + fx (v10 - v00), top likewise, value = bottom + fy (top - bottom); slopes gx = right -
// left, gy = top - bottom, gt = gy x - gx y with the turned point; from the cap on the value is the cap, gx and gy are
// 0. With t = min(1, value * reciprocal(width)) and q = 1 - t^2 it costs width^2 / 1536 (1 - (q q) q) and weighs (q q)
// / 256, the biweight [Beaton1974]. Point i is added to lane i % kLanes; lane i + k is added to lane i for k = kLanes /
// 2, ..., 1. The prior is added last.
#pragma once

#include <array>
#include <cstdint>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// A prior around a mean pose, as input of kernels. Its cost in float32, without contraction, with dx, dy, dt the pose
/// less the mean: a = (dx*dx + dy*dy) * weight_xy, then a = a < limit ? a : limit; b = (dt*dt) * weight_theta, then b =
/// b < limit ? b : limit; cost = a + b. The limit is at most 1e9; NaN counts as the limit.
struct PriorParams {
  float mean_x = 0.0F;  ///< finite, as the other means
  float mean_y = 0.0F;
  float mean_theta = 0.0F;
  float weight_xy = 0.0F;     ///< cost units per squared cell, finite, not negative
  float weight_theta = 0.0F;  ///< cost units per squared radian, finite, not negative
  float limit = 1.0e9F;       ///< 0 to 1e9
};

/// A pose during its descent. Coordinates as in PoseCandidate.
struct PolishedPose {
  float x = 0.0F;
  float y = 0.0F;
  float theta = 0.0F;
  std::uint32_t cost = 0;         ///< at the pose, prior included
  std::uint32_t evaluations = 0;  ///< poses costed so far, over all passes, modulo 2^32
  std::uint32_t stop = 0;         ///< reason for stopping in the last pass: 0 not run, 1 converged, 2 evaluation limit
  std::uint32_t reserved[2] = {0, 0};
};

/// Descends from each pose, in place. A step solves (H + damping diag(H)) step = -gradient by LDL^T, whose reciprocals
/// are three steps of Newton from 0x7EF311C7 minus the bits. The damping [Levenberg1944, Marquardt1963] is 1e-4 at the
/// start of a width; after a step that does not lower the cost, which is undone, and after singular equations it is 1,
/// then four times as much each time: across a wall the field has no slope that fades, and undamped steps leap to and
/// fro over it. A width is done when a step is below the stop, kLoose times as large at all widths but the last, or the
/// damping exceeds 1000; the next one is `narrowing` times as large, at least last_width. `cost` of the result is the
/// last width's, rounded down, at most 2e9. The values are those of point_values.hpp at the end, a row for each pose.
/// Bindings: field (u16, read), points (PointCells, read), poses (PolishedPose, read and write), values (u16 in rows of
/// row_of(point_count), write). Extent: x = poses.
struct PoseDescent {
  static constexpr std::uint32_t kLanes = 64;
  static constexpr float kLoose = 8.0F;
  static constexpr std::uint32_t kMostEvaluations = 56;  ///< some devices end loops after 65,535 turns
  struct Params {
    PoseCost::Params grid;  ///< interpolation and form do not matter: bilinear, distance
    PriorParams prior;
    float width = 5120.0F;       ///< of the first gate, 1/256 cell, positive
    float narrowing = 0.5F;      ///< from 0 to below 1
    float last_width = 1280.0F;  ///< positive
    float stop_cells = 0.01F;    ///< stops when a step is smaller than this in x and y ...
    float stop_rad = 0.0002F;    ///< ... and than this in theta
    std::uint32_t max_evaluations = 40;
  };
  /// Values from a row to the next: whole words.
  static constexpr std::uint32_t row_of(std::uint32_t points) { return (points + 1) / 2 * 2; }
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kReadWrite, Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

}  // namespace gdtslam

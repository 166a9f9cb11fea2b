// Cost of a batch of candidate poses, paper equation (4): the sum over the scan's points of the field at T * P_i.
//
// Arithmetic (docs/numerics.md), the same bits everywhere: per candidate s, c = sin_cos(theta) in float32; per point,
// without contraction, u = (c*x - s*y) + tx and v = (s*x + c*y) + ty in cells, quantised to 1/256 cell by f =
// floor(u*256 + 0.5), then f = f > -2^30 ? f : -2^30 (so NaN counts as far off the map), f = f < 2^30 ? f : 2^30, as
// int32; minus half a cell if `interpolation` is bilinear, because a cell's value belongs to its centre; cell = (q >>
// 8) + anchor, fraction = q & 255. The cell is clamped to [0, width-2] x [0, height-2]: the two outermost rows and
// columns of a field must hold the cap, so that points off the map read it. Bilinear: the four neighbours with integer
// weights (256-fx)(256-fy).. sum to 2^16, shifted right by 16. Nearest: the cell of q. The term is v = min(value, cap),
// or (v*v) >> squared_shift(cap), 16 bits in both cases. The sum is uint32: exact for 65,537 points.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// A candidate pose in cells and radians relative to the lower left corner of the anchor cell (Params), with a prior
/// cost that is added. The anchor keeps the coordinates small, so float32 is fine on any map and results do not change
/// when a map grows.
struct PoseCandidate {
  float x = 0.0F;
  float y = 0.0F;
  float theta = 0.0F;
  std::uint32_t bias = 0;
};

/// The shift that brings the square of any value up to the cap into 16 bits.
constexpr std::uint32_t squared_shift(std::uint32_t cap) {
  const auto bits = 2 * static_cast<std::uint32_t>(std::bit_width(cap));
  return bits > 16 ? bits - 16 : 0;
}

/// Bindings: field (u16, read), points (PointCells, read), candidates (PoseCandidate, read), cost (u32, write; bias +
/// sum, saturating at 2^32-1). Extent: x = candidates.
struct PoseCost {
  struct Params {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;           ///< from row to row
    std::uint32_t strip = kStripWidth;  ///< from strip to strip (kernel.hpp)
    std::uint32_t blank = 0;            ///< cells hold their value XOR this, at most 65535
    std::int32_t anchor_x = 0;          ///< cell of the field that candidates are relative to, any value within +-2^21
    std::int32_t anchor_y = 0;
    std::uint32_t point_count = 0;
    std::uint32_t cap = 0;  ///< values above count as this, 1/256 cell, at most 65535
    Interpolation interpolation = Interpolation::kBilinear;
    CostForm form = CostForm::kDistance;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kRead, Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

}  // namespace gdtslam

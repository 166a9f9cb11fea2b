// Exact Euclidean distance transform in squared cells, paper equation (1) with "(i, j) an obstacle" added.
// Separable in the manner of [Meijster2000]; truncated at a radius so that a window of 2R+1 cells per pass is exact.
//
// Grids of all kernels: row-major, `stride` cells from row to row, stride >= width and a multiple of 4 (kGridStride is
// what the engine uses). Seeds are bytes, non-zero for an obstacle; a kernel of its own makes them from a list of
// cells.
#pragma once

#include <array>
#include <cstdint>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// The engine's grids have rows of a multiple of this many cells.
inline constexpr std::uint32_t kGridStride = 32;
constexpr std::uint32_t grid_stride(std::uint32_t width) {
  return (width + kGridStride - 1) / kGridStride * kGridStride;
}

/// First pass of the truncated transform: distance to the nearest seed of the column, truncated at the radius.
/// Bindings: seeds (u8, read), column distance (u8, write). Extent: x = columns, in blocks as the backend likes; y = 1.
struct EdtColumns {
  struct Params {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
    std::uint32_t radius = 0;  ///< R, 1 to 255 cells
  };
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

/// Second pass: squared distance, u16, truncated at R*R (which also stands for "none within R").
/// Bindings: column distance (u8, read), squared distance (u16, write). Extent: x = 1, y = rows.
struct EdtRows {
  using Params = EdtColumns::Params;
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
};

/// From the points of a scan to the seeds of its transform: sets the seeds that a list of cells names; cells outside
/// the grid are left out, all other seeds stay as they are. Bindings: cells (u32, y * 65536 + x, read), seeds (u8, read
/// and write: 1 where a cell is named, whatever it was). Extent: x = number of cells. Width and height at most 65535.
struct SeedScatter {
  struct Params {
    std::uint32_t count = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kReadWrite};
  static const KernelInfo& info();
};

}  // namespace gdtslam

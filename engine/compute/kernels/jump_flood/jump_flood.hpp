// Jump flooding [Rong2006], [Rong2007]: an approximate distance transform in log2(n) passes over ping-pong buffers. A
// cell holds its best seed so far as the index y * 65536 + x (row-major order without a division; kNoSeed: none);
// candidates are compared by (squared distance, index), so that every backend gives the same bits. Width and height at
// most 32767. Its error against the exact field is measured.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// The engine's grids have rows of a multiple of this many cells.
inline constexpr std::uint32_t kGridStride = 32;
constexpr std::uint32_t grid_stride(std::uint32_t width) {
  return (width + kGridStride - 1) / kGridStride * kGridStride;
}

/// Value of a cell without a seed so far.
inline constexpr std::uint32_t kNoSeed = 0xFFFFFFFFU;

/// Turns the points of a scan into the seeds of its transform: sets the seeds at a list of cells; cells outside the
/// grid are ignored, all other seeds stay. Bindings: cells (u32, y * 65536 + x, read), seeds (u8, read and write: 1 at
/// a listed cell, whatever it was). Extent: x = number of cells. Width and height at most 65535.
struct SeedScatter {
  struct Params {
    std::uint32_t count = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kReadWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

/// Bindings: seeds (u8, read), nearest (u32, write). A seed is its own nearest. Extent: x = width, y = rows.
struct JumpFloodInit {
  struct Params {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
};

/// One pass: each cell compares its own seed with those of eight neighbours `step` cells away.
/// Bindings: nearest (u32, read), nearest (u32, write). Extent: x = width, y = rows.
struct JumpFloodStep {
  struct Params {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
    std::uint32_t step = 0;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
};

/// Squared distance to the nearest seed, u16, truncated at R*R (which also stands for "no seed").
/// Bindings: nearest (u32, read), squared distance (u16, write). Extent: x = width, y = rows.
struct JumpFloodDistance {
  struct Params {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
    std::uint32_t radius = 0;  ///< R, 1 to 255 cells
  };
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
};

/// The steps, first to last, if distances beyond a radius do not matter: 1 first [Rong2007], then steps that halve down
/// to 1. Seeds farther than their sum are not reached, so they begin at the power of two not above the radius.
std::vector<std::uint32_t> jump_flood_steps_within(std::uint32_t radius);

}  // namespace gdtslam

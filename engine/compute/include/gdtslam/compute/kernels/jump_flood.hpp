// Jump flooding [Rong2006], [Rong2007]: an approximate distance transform in log2(n) passes over ping-pong buffers. A
// cell holds its best seed so far as the index y * 65536 + x (row-major order without a division; kNoSeed: none);
// candidates are compared by (squared distance, index), so that every backend gives the same bits. Width and height at
// most 32767. Its error against the exact field is measured, not hidden.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

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

/// One pass: each cell looks at itself and its eight neighbours `step` cells away.
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

/// Squared distance to the nearest seed, u32; kNoSeed where there is none.
/// Bindings: nearest (u32, read), squared distance (u32, write). Extent: x = width, y = rows.
struct JumpFloodDistance {
  using Params = JumpFloodInit::Params;
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
};

/// Variants: plain; one pass of step 1 before it; passes of step 2 and 1 after it; twice.
enum class JumpFloodVariant : std::uint8_t { kPlain, kOnePlus, kPlusTwo, kSquared };
std::string_view name_of(JumpFloodVariant variant);

/// The steps of a variant on a grid, first to last; the plain ones halve from the power of two below the larger side.
std::vector<std::uint32_t> jump_flood_steps(JumpFloodVariant variant, std::uint32_t width, std::uint32_t height);

/// How far an approximate squared distance transform is from the exact one.
struct JumpFloodError {
  std::uint64_t cells = 0;
  std::uint64_t wrong_cells = 0;
  double largest_cells =
      0.0;  ///< largest difference of the distances (not of their squares); infinite where a seed is missed
};
/// Compares two squared distance grids (u32, kNoSeed for none) of one shape.
JumpFloodError jump_flood_error(std::span<const std::uint32_t> exact, std::span<const std::uint32_t> approximate,
                                const JumpFloodInit::Params& shape);

}  // namespace gdtslam

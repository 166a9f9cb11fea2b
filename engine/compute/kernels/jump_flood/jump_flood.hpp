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

struct CaseGroup;

/// What stands for a cell that knows no seed yet.
inline constexpr std::uint32_t kNoSeed = 0xFFFFFFFFU;

/// Bindings: seeds (u8, read), nearest (u32, write). A seed is its own nearest. Extent: x = width, y = rows.
struct JumpFloodInit {
  struct Params {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
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

/// Squared distance to the nearest seed, u16, truncated at R*R (which also stands for "no seed"), as EdtRows leaves it.
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

/// Variants: plain; one pass of step 1 before it; passes of step 2 and 1 after it; twice.
enum class JumpFloodVariant : std::uint8_t { kPlain, kOnePlus, kPlusTwo, kSquared };
std::string_view to_string(JumpFloodVariant variant);

/// The steps of a variant on a grid, first to last; the plain ones halve from the power of two below the larger side.
std::vector<std::uint32_t> jump_flood_steps(JumpFloodVariant variant, std::uint32_t width, std::uint32_t height);
/// Those of 1+jfa where distances beyond a radius do not matter: steps that halve to 1 reach what is not farther than
/// their sum, so they begin at the power of two not above the radius.
std::vector<std::uint32_t> jump_flood_steps_within(std::uint32_t radius);

/// How far an approximate truncated squared distance transform is from the exact one.
struct JumpFloodError {
  std::uint64_t cells = 0;
  std::uint64_t wrong_cells = 0;
  double largest_cells = 0.0;  ///< largest difference of the distances, not of their squares
};
/// Compares two grids of squared distances, truncated at the same radius, of one shape.
JumpFloodError jump_flood_error(std::span<const std::uint16_t> exact, std::span<const std::uint16_t> approximate,
                                const JumpFloodInit::Params& shape);

}  // namespace gdtslam

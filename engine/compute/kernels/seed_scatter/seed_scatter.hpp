// From the points of a scan to the seeds of its distance transform, paper equation (1).
#pragma once

#include <array>
#include <cstdint>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

/// Sets the seeds that a list of cells names; cells outside the grid are left out, all other seeds stay as they are.
/// Bindings: cells (u32, y * 65536 + x, read), seeds (u8, read and write: 1 where a cell is named, whatever it was).
/// Extent: x = number of cells. Width and height at most 65535.
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

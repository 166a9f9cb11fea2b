// A field moved into a larger one: how the map grows without leaving the device.
#pragma once

#include <array>
#include <cstdint>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

/// new(x, y) = old(x - offset_x, y - offset_y) where that lies in the old field, else `cap`. The old field may be empty
/// (0 x 0) and must lie inside the new one. Padding of the new rows may become anything. Bindings: old field (u16,
/// read), new field (u16, write). Extent: x = new width, y = new rows.
struct FieldGrow {
  struct Params {
    std::uint32_t old_width = 0;
    std::uint32_t old_height = 0;
    std::uint32_t old_stride = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
    std::uint32_t offset_x = 0;
    std::uint32_t offset_y = 0;
    std::uint32_t cap = 0;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
};

}  // namespace gdtslam

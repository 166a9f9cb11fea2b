#include "field_grow.hpp"

#include "engine/compute/cpu/launch.hpp"

namespace gdtslam {

const KernelInfo& FieldGrow::info() {
  static const KernelInfo row = kernel_info<FieldGrow>(
      {"field_grow", "cell", "the map of paper equations (9) to (11), enlarged"}, kCall<&IsaFunctions::field_grow>,
      kCells, [](const Params& params, const LaunchCheck& check) {
        check.grid(params.old_width, params.old_height, params.old_stride, kNoLimit);
        check.grid(params.width, params.height, params.stride, kNoLimit);
        check.require(std::uint64_t{params.offset_x} + params.old_width <= params.width &&
                          std::uint64_t{params.offset_y} + params.old_height <= params.height,
                      "the old field sticks out of the new one");
        check.require(params.cap <= 65535, "the cap exceeds 16 bits");
        check.buffer(0, grid_bytes(params.old_width, params.old_height, params.old_stride, 2));
        check.buffer(1, grid_bytes(params.width, params.height, params.stride, 2));
        check.extent({params.width, params.height, 1});
      });
  return row;
}

}  // namespace gdtslam

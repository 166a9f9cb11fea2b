#include "gdt_merge.hpp"

#include "engine/compute/cpu/launch.hpp"

namespace gdtslam {

const KernelInfo& GdtMerge::info() {
  static const KernelInfo row = kernel_info<GdtMerge>(
      {"gdt_merge", "cell", "paper equations (9) to (11)"}, kCall<&IsaFunctions::gdt_merge>,
      [](const Params& params, Extent) -> std::uint64_t {
        return std::uint64_t{params.scan_width} * params.scan_height;
      },
      [](const Params& params, const LaunchCheck& check) {
        check.grid(params.scan_width, params.scan_height, params.scan_stride, kNoLimit);
        check.require(std::uint64_t{params.offset_x} + params.scan_width <= kNoLimit &&
                          std::uint64_t{params.offset_y} + params.scan_height <= kNoLimit,
                      "the offset is too large");
        const FieldLayout global{params.global_stride, params.global_strip, params.blank};
        const std::uint32_t width = params.offset_x + params.scan_width;
        const std::uint32_t height = params.offset_y + params.scan_height;
        check.layout(global, width, height, kNoLimit);
        check.require(params.lift <= params.threshold, "the lift exceeds the threshold");
        check.require(params.cap <= 65535, "the cap exceeds 16 bits");
        check.require(params.rule == MergeRule::kWorking || params.rule == MergeRule::kLiteral, "unknown rule");
        check.buffer(0, field_bytes(global, width, height));
        check.buffer(1, grid_bytes(params.scan_width, params.scan_height, params.scan_stride, 2));
        check.extent({params.scan_width, params.scan_height, 1});
      });
  return row;
}
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

#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"

#include "grid_launch.hpp"
#include "variant_tools.hpp"

namespace gdtslam {
namespace {

/// The quads of the global field's row that the scan's field touches.
template <std::uint32_t kQuads, std::uint32_t kRowsEach>
GroupCount groups(const LaunchShape& shape) {
  const auto params = launch_params<GdtMerge>(shape);
  const std::uint32_t first = params.offset_x / 4;
  const std::uint32_t end = divided_up(params.offset_x + params.scan_width, 4);
  return grid_groups(end - first, kQuads, params.scan_height, kRowsEach);
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "gdt_merge",
     .name = "gdt_merge",
     .spirv = shader::gdt_merge_spirv,
     .local_size = {32, 1, 1},
     .groups = groups<32, 16>,
     .suits = wants_narrow},
    {.kernel = "gdt_merge",
     .name = "gdt_merge",
     .spirv = shader::gdt_merge_spirv,
     .local_size = {128, 1, 1},
     .groups = groups<128, 1>},
};

}  // namespace

std::span<const ShaderVariant> gdt_merge_variants() { return kVariants; }

}  // namespace gdtslam

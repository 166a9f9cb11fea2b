#include "engine/compute/kernels/edt/edt.hpp"
#include "grid_launch.hpp"
#include "variant_tools.hpp"

namespace gdtslam {
namespace {

template <std::uint32_t kCellsEach, std::uint32_t kGroup, std::uint32_t kRowsEach>
GroupCount groups(const LaunchShape& shape) {
  const auto params = launch_params<EdtRows>(shape);
  return grid_groups(divided_up(params.width, kCellsEach), kGroup, params.height, kRowsEach);
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "edt_rows",
     .name = "edt_rows_narrow",
     .spirv = shader::edt_rows_narrow_spirv,
     .local_size = {16, 1, 1},
     .groups = groups<8, 16, 16>,
     .suits = wants_narrow},
    {.kernel = "edt_rows",
     .name = "edt_rows_wide",
     .spirv = shader::edt_rows_wide_spirv,
     .local_size = {128, 1, 1},
     .groups = groups<2, 128, 1>},
};

}  // namespace

std::span<const ShaderVariant> edt_rows_variants() { return kVariants; }

}  // namespace gdtslam

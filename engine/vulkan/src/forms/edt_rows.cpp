#include "forms/form_tools.hpp"
#include "forms/grid_launch.hpp"
#include "gdtslam/compute/kernels/edt.hpp"

namespace gdtslam {
namespace {

template <std::uint32_t kCellsEach, std::uint32_t kGroup, std::uint32_t kRowsEach>
GroupCount groups(const LaunchShape& shape) {
  const auto params = launch_params<EdtRows>(shape);
  return grid_groups(divided_up(params.width, kCellsEach), kGroup, params.height, kRowsEach);
}

constexpr ShaderForm kForms[] = {
    {.kernel = "edt_rows",
     .name = "edt_rows_wide",
     .spirv = shader::edt_rows_wide_spirv,
     .local_size = {128, 1, 1},
     .groups = groups<2, 128, 1>,
     .suits = wants_wide},
    {.kernel = "edt_rows",
     .name = "edt_rows_narrow",
     .spirv = shader::edt_rows_narrow_spirv,
     .local_size = {16, 1, 1},
     .groups = groups<8, 16, 16>},
};

}  // namespace

std::span<const ShaderForm> edt_rows_forms() { return kForms; }

}  // namespace gdtslam

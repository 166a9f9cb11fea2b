#include "engine/compute/kernels/edt/edt.hpp"
#include "grid_launch.hpp"
#include "variant_tools.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kWideWords = 64;  // of a group: 256 columns
constexpr std::uint32_t kStripRows = 16;
constexpr std::uint32_t kNarrowWords = 8;

GroupCount wide_groups(const LaunchShape& shape) {
  const auto params = launch_params<EdtColumns>(shape);
  return grid_groups(divided_up(params.width, 4), kWideWords, params.height, kStripRows);
}

GroupCount narrow_groups(const LaunchShape& shape) {
  return grid_groups(divided_up(launch_params<EdtColumns>(shape).width, 4), kNarrowWords, 1, 1);
}

bool is_narrow(const VariantContext& context) {
  return wants_narrow(context) &&
         fits_loops(context, 2 * std::uint64_t{launch_params<EdtColumns>(context.shape).height});
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "edt_columns",
     .name = "edt_columns_narrow",
     .spirv = shader::edt_columns_narrow_spirv,
     .local_size = {kNarrowWords, 1, 1},
     .groups = narrow_groups,
     .suits = is_narrow},
    {.kernel = "edt_columns",
     .name = "edt_columns_wide",
     .spirv = shader::edt_columns_wide_spirv,
     .local_size = {kWideWords, 1, 1},
     .constants = {kStripRows, 0},
     .groups = wide_groups},
};

}  // namespace

std::span<const ShaderVariant> edt_columns_variants() { return kVariants; }

}  // namespace gdtslam

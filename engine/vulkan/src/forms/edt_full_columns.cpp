#include "forms/form_tools.hpp"
#include "forms/grid_launch.hpp"
#include "gdtslam/compute/kernels/edt.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kWideQuads = 4;  // of a group: 16 columns, a run of 64 bytes of a row of the result
// Of a column. The shader has room for 256 invocations, of which every device runs 128.
constexpr std::uint32_t kWideStrips = 64;
constexpr std::uint32_t kSmallStrips = 32;
static_assert(kWideQuads * kSmallStrips <= kEveryDevicesGroup);
constexpr std::uint32_t kNarrowQuads = 8;

template <std::uint32_t kQuads>
GroupCount groups(const LaunchShape& shape) {
  return grid_groups(divided_up(launch_params<EdtFullColumns>(shape).width, 4), kQuads, 1, 1);
}

bool is_low(const FormContext& context) {
  return fits_loops(context, 2 * std::uint64_t{launch_params<EdtFullColumns>(context.shape).height});
}

constexpr ShaderForm wide_form(std::uint32_t strips, bool (*suits)(const FormContext&)) {
  return {.kernel = "edt_full_columns",
          .name = "edt_full_columns_wide",
          .spirv = shader::edt_full_columns_wide_spirv,
          .local_size = {kWideQuads, strips, 1},
          .groups = groups<kWideQuads>,
          .suits = suits};
}

constexpr ShaderForm kForms[] = {
    wide_form(kWideStrips, wants_wide),
    wide_form(kSmallStrips, wants_wide),
    {.kernel = "edt_full_columns",
     .name = "edt_full_columns_narrow",
     .spirv = shader::edt_full_columns_narrow_spirv,
     .local_size = {kNarrowQuads, 1, 1},
     .groups = groups<kNarrowQuads>,
     .suits = is_low},
    wide_form(kSmallStrips, nullptr),
};

}  // namespace

std::span<const ShaderForm> edt_full_columns_forms() { return kForms; }

}  // namespace gdtslam

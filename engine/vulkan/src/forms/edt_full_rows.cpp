#include "forms/form_tools.hpp"
#include "forms/grid_launch.hpp"
#include "gdtslam/compute/kernels/edt.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kNarrowRows = 8;  // of a group
constexpr std::uint32_t kWideGroup = 256;
constexpr std::uint32_t kSmallGroup = kEveryDevicesGroup;
constexpr std::uint32_t kWideCells = 4;  // of an invocation

GroupCount narrow_groups(const LaunchShape& shape) {
  return groups_for(launch_params<EdtFullRows>(shape).height, kNarrowRows);
}

template <std::uint32_t kGroup>
GroupCount wide_groups(const LaunchShape& shape) {
  const auto params = launch_params<EdtFullRows>(shape);
  return folded(std::uint64_t{divided_up(params.width, kGroup * kWideCells)} * params.height);
}

/// Building the envelope takes at most two turns of a loop a column, filling the row a quarter.
bool is_short(const FormContext& context) {
  return fits_loops(context, 3 * std::uint64_t{launch_params<EdtFullRows>(context.shape).width});
}

template <std::uint32_t kGroup>
constexpr ShaderForm wide_form(bool (*suits)(const FormContext&)) {
  return {.kernel = "edt_full_rows",
          .name = "edt_full_rows_wide",
          .spirv = shader::edt_full_rows_wide_spirv,
          .local_size = {kGroup, 1, 1},
          .constants = {kWideCells, 0},
          .groups = wide_groups<kGroup>,
          .suits = suits};
}

constexpr ShaderForm kForms[] = {
    wide_form<kWideGroup>(wants_wide),
    wide_form<kSmallGroup>(wants_wide),
    {.kernel = "edt_full_rows",
     .name = "edt_full_rows_narrow",
     .spirv = shader::edt_full_rows_narrow_spirv,
     .local_size = {kNarrowRows, 1, 1},
     .groups = narrow_groups,
     .suits = is_short},
    wide_form<kSmallGroup>(nullptr),
};

}  // namespace

std::span<const ShaderForm> edt_full_rows_forms() { return kForms; }

}  // namespace gdtslam

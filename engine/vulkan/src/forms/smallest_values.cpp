#include "gdtslam/compute/kernels/pose_lattice.hpp"

#include "forms/form_tools.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kManyInvocations = 1024;
constexpr std::uint32_t kFewInvocations = 8;

GroupCount one_group(const LaunchShape&) { return {}; }

/// Whether few invocations do not take too many turns of their loops: two a block of sixteen values, and the merge.
bool fits_few(const FormContext& context) {
  const std::uint64_t blocks = launch_params<SmallestValues>(context.shape).count / (kFewInvocations * 16);
  return fits_loops(context, 2 * blocks + 1000);
}

/// Also for devices that like few, where those would take too many turns.
bool takes_many(const FormContext& context) {
  return (context.wide() || !fits_few(context)) && context.device.max_group_invocations >= kManyInvocations;
}

constexpr ShaderForm kForms[] = {
    {.kernel = "smallest_values",
     .name = "smallest_values_wide",
     .spirv = shader::smallest_values_wide_spirv,
     .local_size = {kManyInvocations, 1, 1},
     .groups = one_group,
     .suits = takes_many},
    {.kernel = "smallest_values",
     .name = "smallest_values_wide",
     .spirv = shader::smallest_values_wide_spirv,
     .local_size = {128, 1, 1},
     .groups = one_group,
     .suits = wants_wide},
    {.kernel = "smallest_values",
     .name = "smallest_values_narrow",
     .spirv = shader::smallest_values_narrow_spirv,
     .local_size = {kFewInvocations, 1, 1},
     .groups = one_group},
};

}  // namespace

std::span<const ShaderForm> smallest_values_forms() { return kForms; }

}  // namespace gdtslam

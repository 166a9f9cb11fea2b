#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"

#include "variant_tools.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kManyInvocations = 1024;
constexpr std::uint32_t kFewInvocations = 8;

GroupCount one_group(const LaunchShape&) { return {}; }

/// Whether few invocations do not take too many turns of their loops: two a block of sixteen values, and the merge.
bool fits_few(const VariantContext& context) {
  const std::uint64_t blocks = launch_params<SmallestValues>(context.shape).count / (kFewInvocations * 16);
  return fits_loops(context, 2 * blocks + 1000);
}

bool is_narrow(const VariantContext& context) { return wants_narrow(context) && fits_few(context); }

bool takes_many(const VariantContext& context) { return context.device.max_group_invocations >= kManyInvocations; }

constexpr ShaderVariant wide_variant(std::uint32_t invocations, bool (*suits)(const VariantContext&)) {
  return {.kernel = "smallest_values",
          .name = "smallest_values_wide",
          .spirv = shader::smallest_values_wide_spirv,
          .local_size = {invocations, 1, 1},
          .groups = one_group,
          .suits = suits};
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "smallest_values",
     .name = "smallest_values_narrow",
     .spirv = shader::smallest_values_narrow_spirv,
     .local_size = {kFewInvocations, 1, 1},
     .groups = one_group,
     .suits = is_narrow},
    wide_variant(kManyInvocations, takes_many),
    wide_variant(128, nullptr),
};

}  // namespace

std::span<const ShaderVariant> smallest_values_variants() { return kVariants; }

}  // namespace gdtslam

#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"

#include "variant_tools.hpp"

namespace gdtslam {
namespace {

GroupCount one_group(const LaunchShape&) { return {}; }

constexpr std::uint32_t kFewInvocations = 8;

/// Few invocations suit a CPU, unless each would take too many turns: one pose of eight, or two or three of more,
/// through all points.
bool is_for_few(const VariantContext& context) {
  const auto params = launch_params<ChoosePose>(context.shape);
  const std::uint64_t poses_each = (params.pose_count + kFewInvocations - 1) / kFewInvocations;
  return wants_narrow(context) && fits_loops(context, poses_each * (params.cost.point_count + 1) + 100);
}

constexpr ShaderVariant variant(std::uint32_t invocations, bool (*suits)(const VariantContext&)) {
  return {.kernel = "choose_pose",
          .name = "choose_pose",
          .spirv = shader::choose_pose_spirv,
          .local_size = {invocations, 1, 1},
          .groups = one_group,
          .suits = suits};
}

constexpr ShaderVariant kVariants[] = {variant(kFewInvocations, is_for_few), variant(128, nullptr)};

}  // namespace

std::span<const ShaderVariant> choose_pose_variants() { return kVariants; }

}  // namespace gdtslam

#include "gdtslam/compute/kernels/pose_simplex.hpp"

#include "forms/form_tools.hpp"

namespace gdtslam {
namespace {

GroupCount one_group(const LaunchShape&) { return {}; }

constexpr std::uint32_t kFewInvocations = 8;

/// Also for devices that like few invocations, where those would take too many turns: each takes one pose of eight, or
/// two or three of more, through all points.
bool takes_many(const FormContext& context) {
  const auto params = launch_params<ChoosePose>(context.shape);
  const std::uint64_t poses_each = (params.pose_count + kFewInvocations - 1) / kFewInvocations;
  return context.wide() || !fits_loops(context, poses_each * (params.cost.point_count + 1) + 100);
}

constexpr ShaderForm form(std::uint32_t invocations, bool (*suits)(const FormContext&)) {
  return {.kernel = "choose_pose",
          .name = "choose_pose",
          .spirv = shader::choose_pose_spirv,
          .local_size = {invocations, 1, 1},
          .groups = one_group,
          .suits = suits};
}

constexpr ShaderForm kForms[] = {
    form(128, takes_many),
    with_texels(form(kFewInvocations, nullptr), "choose_pose_texel", shader::choose_pose_texel_spirv),
    form(kFewInvocations, nullptr),
};

}  // namespace

std::span<const ShaderForm> choose_pose_forms() { return kForms; }

}  // namespace gdtslam

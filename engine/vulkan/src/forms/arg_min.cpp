#include "forms/form_tools.hpp"
#include "gdtslam/compute/kernels/pose_cost.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kLargeGroup = 1024;
constexpr std::uint32_t kSmallGroup = 8;
constexpr std::uint32_t kCostsATurn = 8;  // of an invocation

GroupCount one_group(const LaunchShape&) { return {1, 1, 1}; }

bool is_for_few(const FormContext& context) {
  const std::uint32_t count = launch_params<ArgMin>(context.shape).count;
  return !context.wide() && fits_loops(context, count / (kSmallGroup * kCostsATurn) + 100);
}

bool takes_large_groups(const FormContext& context) { return context.device.max_group_invocations >= kLargeGroup; }

constexpr ShaderForm form(std::uint32_t invocations, bool (*suits)(const FormContext&)) {
  return {.kernel = "arg_min",
          .name = "arg_min",
          .spirv = shader::arg_min_spirv,
          .local_size = {invocations, 1, 1},
          .groups = one_group,
          .suits = suits};
}

constexpr ShaderForm kForms[] = {form(kSmallGroup, is_for_few), form(kLargeGroup, takes_large_groups),
                                 form(128, nullptr)};

}  // namespace

std::span<const ShaderForm> arg_min_forms() { return kForms; }

}  // namespace gdtslam

#include "gdtslam/compute/kernels/pose_cost.hpp"

#include "forms/form_tools.hpp"

namespace gdtslam {
namespace {

/// Below so many candidates an invocation each leaves most of a GPU idle.
constexpr std::uint32_t kLargeBatch = 16384;
constexpr int kPoints = 1;  // their binding

template <std::uint32_t kEach>
GroupCount groups(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kEach);
}

template <Interpolation kInterpolation>
bool interpolates(const FormContext& context) {
  return launch_params<PoseCost>(context.shape).interpolation == kInterpolation;
}

template <Interpolation kInterpolation>
bool is_wide(const FormContext& context) {
  return context.wide() && interpolates<kInterpolation>(context);
}

template <Interpolation kInterpolation>
bool is_small_batch(const FormContext& context) {
  return context.shape.threads.x < kLargeBatch && is_wide<kInterpolation>(context);
}

template <Interpolation kInterpolation>
bool has_few_points(const FormContext& context) {
  return launch_params<PoseCost>(context.shape).point_count <= kUniformPoints && interpolates<kInterpolation>(context);
}

template <Interpolation kInterpolation>
bool is_wide_with_few_points(const FormContext& context) {
  return context.wide() && has_few_points<kInterpolation>(context);
}

/// The forms for one interpolation, which is a constant of the shaders.
template <Interpolation kInterpolation>
constexpr std::array<ShaderForm, 5> forms() {
  constexpr std::array<std::uint32_t, 2> kConstants{static_cast<std::uint32_t>(kInterpolation), 0};
  return {{{.kernel = "pose_cost",
            .name = "pose_cost_group",
            .spirv = shader::pose_cost_group_spirv,
            .local_size = {64, 1, 1},
            .constants = kConstants,
            .takes_count = true,
            .groups = groups<1>,
            .suits = is_small_batch<kInterpolation>},
           {.kernel = "pose_cost",
            .name = "pose_cost_wide_uniform",
            .spirv = shader::pose_cost_wide_uniform_spirv,
            .local_size = {128, 1, 1},
            .constants = kConstants,
            .uniform_binding = kPoints,
            .takes_count = true,
            .groups = groups<128>,
            .suits = is_wide_with_few_points<kInterpolation>},
           {.kernel = "pose_cost",
            .name = "pose_cost_wide_storage",
            .spirv = shader::pose_cost_wide_storage_spirv,
            .local_size = {128, 1, 1},
            .constants = kConstants,
            .takes_count = true,
            .groups = groups<128>,
            .suits = is_wide<kInterpolation>},
           {.kernel = "pose_cost",
            .name = "pose_cost_narrow_uniform",
            .spirv = shader::pose_cost_narrow_uniform_spirv,
            .local_size = {8, 1, 1},
            .constants = kConstants,
            .uniform_binding = kPoints,
            .takes_count = true,
            .groups = groups<32>,
            .suits = has_few_points<kInterpolation>},
           {.kernel = "pose_cost",
            .name = "pose_cost_narrow_storage",
            .spirv = shader::pose_cost_narrow_storage_spirv,
            .local_size = {8, 1, 1},
            .constants = kConstants,
            .takes_count = true,
            .groups = groups<32>,
            .suits = interpolates<kInterpolation>}}};
}

constexpr auto all_forms() {
  constexpr auto kNearest = forms<Interpolation::kNearest>();
  std::array<ShaderForm, 2 * kNearest.size()> all{};
  std::copy(kNearest.begin(), kNearest.end(), all.begin());
  constexpr auto kBilinear = forms<Interpolation::kBilinear>();
  std::copy(kBilinear.begin(), kBilinear.end(), all.begin() + kNearest.size());
  all.back().suits = nullptr;
  return all;
}

constexpr auto kForms = all_forms();

}  // namespace

std::span<const ShaderForm> pose_cost_forms() { return kForms; }

}  // namespace gdtslam

#include "gdtslam/compute/kernels/pose_cost.hpp"

#include "forms/form_tools.hpp"

namespace gdtslam {
namespace {

/// Below so many candidates an invocation each leaves most of a GPU idle.
constexpr std::uint32_t kLargeBatch = 16384;
constexpr int kPoints = 1;  // their binding
/// Fewer candidates leave most lanes of a CPU idle. Reads of a storage buffer pass these over, those of texels do not.
constexpr std::uint32_t kTexelBatch = 16;

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

/// With enough candidates for texels.
template <Interpolation kInterpolation>
bool has_few_points_and_a_batch(const FormContext& context) {
  return context.shape.threads.x >= kTexelBatch && has_few_points<kInterpolation>(context);
}

template <Interpolation kInterpolation>
bool is_batch(const FormContext& context) {
  return context.shape.threads.x >= kTexelBatch && interpolates<kInterpolation>(context);
}

template <Interpolation kInterpolation>
bool is_wide_with_few_points(const FormContext& context) {
  return context.wide() && has_few_points<kInterpolation>(context);
}

template <Interpolation kInterpolation>
constexpr ShaderForm form(std::string_view name, std::span<const std::uint32_t> spirv, std::uint32_t local_size) {
  return {.kernel = "pose_cost",
          .name = name,
          .spirv = spirv,
          .local_size = {local_size, 1, 1},
          .constants = {static_cast<std::uint32_t>(kInterpolation), 0},
          .takes_count = true};
}

/// The forms for one interpolation, which is a constant of the shaders.
template <Interpolation kInterpolation>
constexpr std::array<ShaderForm, 7> forms() {
  ShaderForm group = form<kInterpolation>("pose_cost_group", shader::pose_cost_group_spirv, 64);
  group.groups = groups<1>;
  group.suits = is_small_batch<kInterpolation>;
  ShaderForm wide = form<kInterpolation>("pose_cost_wide", shader::pose_cost_wide_spirv, 128);
  wide.uniform_binding = kPoints;
  wide.groups = groups<128>;
  wide.suits = is_wide_with_few_points<kInterpolation>;
  ShaderForm narrow = form<kInterpolation>("pose_cost_narrow_uniform", shader::pose_cost_narrow_uniform_spirv, 8);
  narrow.uniform_binding = kPoints;
  narrow.groups = groups<8 * 4>;
  narrow.suits = has_few_points<kInterpolation>;
  ShaderForm wide_many = form<kInterpolation>("pose_cost_narrow_storage", shader::pose_cost_narrow_storage_spirv, 64);
  wide_many.groups = groups<64 * 4>;
  wide_many.suits = is_wide<kInterpolation>;
  ShaderForm many = form<kInterpolation>("pose_cost_narrow_storage", shader::pose_cost_narrow_storage_spirv, 8);
  many.groups = groups<8 * 4>;
  many.suits = interpolates<kInterpolation>;
  ShaderForm narrow_texel =
      with_texels(narrow, "pose_cost_narrow_uniform_texel", shader::pose_cost_narrow_uniform_texel_spirv);
  narrow_texel.suits = has_few_points_and_a_batch<kInterpolation>;
  ShaderForm many_texel =
      with_texels(many, "pose_cost_narrow_storage_texel", shader::pose_cost_narrow_storage_texel_spirv);
  many_texel.suits = is_batch<kInterpolation>;
  return {group, wide, narrow_texel, narrow, wide_many, many_texel, many};
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

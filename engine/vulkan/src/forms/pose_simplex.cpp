#include "gdtslam/compute/kernels/pose_simplex.hpp"

#include "forms/form_tools.hpp"

namespace gdtslam {
namespace {

constexpr int kPoints = 1;  // their binding

template <std::uint32_t kEach>
GroupCount groups(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kEach);
}

template <Interpolation kInterpolation>
bool interpolates(const FormContext& context) {
  return launch_params<PoseSimplex>(context.shape).cost.interpolation == kInterpolation;
}

constexpr std::uint32_t kGroup = 128;
/// The group for descents so long that a device which ends loops needs many invocations, and points a turn of its loop.
constexpr std::uint32_t kLargeGroup = 1024;
constexpr std::uint32_t kPointsATurn = 16;

/// Whether `turns` turns of a loop for each pose that is costed are few enough.
bool fits(const FormContext& context, std::uint32_t turns) {
  // The last move costs up to five poses beyond the limit.
  const std::uint64_t evaluations = std::uint64_t{launch_params<PoseSimplex>(context.shape).max_evaluations} + 5;
  return fits_loops(context, evaluations * (turns + 1));
}
static_assert((PoseSimplex::kMostEvaluations + 5) * (65537U / (kLargeGroup * kPointsATurn) + 2) < 65535,
              "the largest form takes every descent");

std::uint32_t points_of(const FormContext& context) {
  return launch_params<PoseSimplex>(context.shape).cost.point_count;
}

/// Whether an invocation a pose, which goes through all points, does not take too many turns.
bool fits_narrow(const FormContext& context) { return fits(context, points_of(context) / 8 + 8); }
/// The same of a group a pose.
bool fits_wide(const FormContext& context) { return fits(context, points_of(context) / kGroup + 1); }

/// Also for devices that like few invocations, where those would take too many turns.
template <Interpolation kInterpolation>
bool is_wide(const FormContext& context) {
  return (context.wide() || !fits_narrow(context)) && fits_wide(context) && interpolates<kInterpolation>(context);
}

template <Interpolation kInterpolation>
bool is_long(const FormContext& context) {
  return (context.wide() || !fits_narrow(context)) && !fits_wide(context) && interpolates<kInterpolation>(context);
}

template <Interpolation kInterpolation>
bool has_few_points(const FormContext& context) {
  return points_of(context) <= kUniformPoints && interpolates<kInterpolation>(context);
}

template <Interpolation kInterpolation>
constexpr ShaderForm wide_form(std::uint32_t group, std::uint32_t points_a_turn) {
  return {.kernel = "pose_simplex",
          .name = "pose_simplex_wide",
          .spirv = shader::pose_simplex_wide_spirv,
          .local_size = {group, 1, 1},
          .constants = {static_cast<std::uint32_t>(kInterpolation), points_a_turn},
          .takes_count = true,
          .groups = groups<1>};
}

template <Interpolation kInterpolation>
constexpr ShaderForm narrow_form(std::string_view name, std::span<const std::uint32_t> spirv) {
  return {.kernel = "pose_simplex",
          .name = name,
          .spirv = spirv,
          .local_size = {8, 1, 1},
          .constants = {static_cast<std::uint32_t>(kInterpolation), 0},
          .takes_count = true,
          .groups = groups<8>};
}

/// The forms are listed once for each interpolation, which is a constant of the shader.
template <Interpolation kInterpolation>
constexpr std::array<ShaderForm, 6> forms() {
  ShaderForm wide = wide_form<kInterpolation>(kGroup, 1);
  wide.suits = is_wide<kInterpolation>;
  ShaderForm large = wide_form<kInterpolation>(kLargeGroup, kPointsATurn);
  large.suits = is_long<kInterpolation>;
  ShaderForm few =
      narrow_form<kInterpolation>("pose_simplex_narrow_uniform", shader::pose_simplex_narrow_uniform_spirv);
  few.uniform_binding = kPoints;
  few.suits = has_few_points<kInterpolation>;
  ShaderForm many = narrow_form<kInterpolation>("pose_simplex_narrow", shader::pose_simplex_narrow_spirv);
  many.suits = interpolates<kInterpolation>;
  const ShaderForm few_texel =
      with_texels(few, "pose_simplex_narrow_uniform_texel", shader::pose_simplex_narrow_uniform_texel_spirv);
  const ShaderForm many_texel = with_texels(many, "pose_simplex_narrow_texel", shader::pose_simplex_narrow_texel_spirv);
  return {wide, large, few_texel, few, many_texel, many};
}

constexpr auto all_forms() {
  constexpr auto kNearest = forms<Interpolation::kNearest>();
  constexpr auto kBilinear = forms<Interpolation::kBilinear>();
  std::array<ShaderForm, 2 * kNearest.size()> all{};
  for (std::size_t i = 0; i < kNearest.size(); ++i) {
    all[i] = kNearest[i];
    all[i + kNearest.size()] = kBilinear[i];
  }
  all.back().suits = nullptr;
  return all;
}

constexpr std::array kForms = all_forms();

}  // namespace

std::span<const ShaderForm> pose_simplex_forms() { return kForms; }

}  // namespace gdtslam

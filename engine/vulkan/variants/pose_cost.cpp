#include "engine/compute/kernels/pose_cost/pose_cost.hpp"

#include "variant_tools.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kNarrowGroup = 8;
constexpr std::uint32_t kNarrowCandidates = 4;  // of an invocation
constexpr std::uint32_t kWideGroup = 64;

template <std::uint32_t kEach>
GroupCount groups(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kEach);
}

template <Interpolation kInterpolation>
bool interpolates(const VariantContext& context) {
  return launch_params<PoseCost>(context.shape).interpolation == kInterpolation;
}

template <Interpolation kInterpolation>
bool is_narrow(const VariantContext& context) {
  return wants_narrow(context) && interpolates<kInterpolation>(context) &&
         launch_params<PoseCost>(context.shape).point_count <= kUniformPoints;
}

/// The variants for one interpolation, which is a constant of the shaders.
template <Interpolation kInterpolation>
constexpr std::array<ShaderVariant, 2> variants() {
  constexpr std::array<std::uint32_t, 2> kConstants{static_cast<std::uint32_t>(kInterpolation), 0};
  return {{{.kernel = "pose_cost",
            .name = "pose_cost_narrow",
            .spirv = shader::pose_cost_narrow_spirv,
            .local_size = {kNarrowGroup, 1, 1},
            .constants = kConstants,
            .uniform_binding = kPointsBinding,
            .texel_binding = kFieldBinding,
            .takes_count = true,
            .groups = groups<kNarrowGroup * kNarrowCandidates>,
            .suits = is_narrow<kInterpolation>},
           {.kernel = "pose_cost",
            .name = "pose_cost_wide",
            .spirv = shader::pose_cost_wide_spirv,
            .local_size = {kWideGroup, 1, 1},
            .constants = kConstants,
            .takes_count = true,
            .groups = groups<1>,
            .suits = interpolates<kInterpolation>}}};
}

constexpr auto kVariants = joined(variants<Interpolation::kNearest>(), variants<Interpolation::kBilinear>());

}  // namespace

std::span<const ShaderVariant> pose_cost_variants() { return kVariants; }

}  // namespace gdtslam

#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"

#include "variant_tools.hpp"

namespace gdtslam {
namespace {

template <std::uint32_t kEach>
GroupCount groups(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kEach);
}

template <Interpolation kInterpolation>
bool interpolates(const VariantContext& context) {
  return launch_params<PoseSimplex>(context.shape).cost.interpolation == kInterpolation;
}

constexpr std::uint32_t kNarrowGroup = 8;
constexpr std::uint32_t kGroup = 128;
/// The group for descents so long that a device which ends loops needs many invocations, and points a turn of its loop.
constexpr std::uint32_t kLargeGroup = 1024;
constexpr std::uint32_t kPointsATurn = 16;

/// Whether `turns` turns of a loop for each pose that is costed are few enough.
bool fits(const VariantContext& context, std::uint32_t turns) {
  // The last move costs up to five poses beyond the limit.
  const std::uint64_t evaluations = std::uint64_t{launch_params<PoseSimplex>(context.shape).max_evaluations} + 5;
  return fits_loops(context, evaluations * (turns + 1));
}
static_assert((PoseSimplex::kMostEvaluations + 5) * (65537U / (kLargeGroup * kPointsATurn) + 2) < 65535,
              "the largest group takes every descent");

std::uint32_t points_of(const VariantContext& context) {
  return launch_params<PoseSimplex>(context.shape).cost.point_count;
}

/// Whether an invocation a pose, which goes through all points, takes them and not too many turns.
template <Interpolation kInterpolation>
bool is_narrow(const VariantContext& context) {
  const std::uint32_t points = points_of(context);
  return wants_narrow(context) && interpolates<kInterpolation>(context) && points <= kUniformPoints &&
         fits(context, points / 8 + 8);
}

/// Whether a group of the usual size would take too many turns.
template <Interpolation kInterpolation>
bool is_long(const VariantContext& context) {
  return interpolates<kInterpolation>(context) && !fits(context, points_of(context) / kGroup + 1);
}

template <Interpolation kInterpolation>
constexpr ShaderVariant wide_variant(std::uint32_t group, std::uint32_t points_a_turn,
                                     bool (*suits)(const VariantContext&)) {
  return {.kernel = "pose_simplex",
          .name = "pose_simplex_wide",
          .spirv = shader::pose_simplex_wide_spirv,
          .local_size = {group, 1, 1},
          .constants = {static_cast<std::uint32_t>(kInterpolation), points_a_turn},
          .takes_count = true,
          .groups = groups<1>,
          .suits = suits};
}

/// The variants for one interpolation, which is a constant of the shaders.
template <Interpolation kInterpolation>
constexpr std::array<ShaderVariant, 3> variants() {
  return {{{.kernel = "pose_simplex",
            .name = "pose_simplex_narrow",
            .spirv = shader::pose_simplex_narrow_spirv,
            .local_size = {kNarrowGroup, 1, 1},
            .constants = {static_cast<std::uint32_t>(kInterpolation), 0},
            .uniform_binding = kPointsBinding,
            .texel_binding = kFieldBinding,
            .takes_count = true,
            .groups = groups<kNarrowGroup>,
            .suits = is_narrow<kInterpolation>},
           wide_variant<kInterpolation>(kLargeGroup, kPointsATurn, is_long<kInterpolation>),
           wide_variant<kInterpolation>(kGroup, 1, interpolates<kInterpolation>)}};
}

constexpr auto kVariants = joined(variants<Interpolation::kNearest>(), variants<Interpolation::kBilinear>());

}  // namespace

std::span<const ShaderVariant> pose_simplex_variants() { return kVariants; }

}  // namespace gdtslam

#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"

#include "variant_tools.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kNarrowGroup = 8;
constexpr std::uint32_t kWideGroup = 128;
/// Points that a uniform buffer of the size that every device allows takes.
constexpr std::uint32_t kUniformBoundPoints = 16384 / sizeof(BoundPoint);

/// Whether tiles are of 16 x 4 boxes, which is a constant of the shaders.
enum class TileShape : std::uint32_t { kSmall = 0, kWide = 1 };

template <TileShape kShape>
bool has_shape(const VariantContext& context) {
  return (launch_params<PoseBounds>(context.shape).tile_width != 2) == (kShape == TileShape::kWide);
}

template <TileShape kShape>
bool is_narrow(const VariantContext& context) {
  return wants_narrow(context) && has_shape<kShape>(context) &&
         launch_params<PoseBounds>(context.shape).point_count <= kUniformBoundPoints;
}

template <std::uint32_t kEach>
GroupCount groups(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kEach);
}

/// The variants for tiles of one shape.
template <TileShape kShape>
constexpr std::array<ShaderVariant, 2> variants() {
  constexpr std::array<std::uint32_t, 2> kConstants{static_cast<std::uint32_t>(kShape), 0};
  return {{{.kernel = "pose_bounds",
            .name = "pose_bounds_narrow",
            .spirv = shader::pose_bounds_narrow_spirv,
            .local_size = {kNarrowGroup, 1, 1},
            .constants = kConstants,
            .uniform_binding = kPointsBinding,
            .texel_binding = kFieldBinding,
            .takes_count = true,
            .groups = groups<kNarrowGroup>,
            .suits = is_narrow<kShape>},
           {.kernel = "pose_bounds",
            .name = "pose_bounds_wide",
            .spirv = shader::pose_bounds_wide_spirv,
            .local_size = {kWideGroup, 1, 1},
            .constants = kConstants,
            .takes_count = true,
            .groups = groups<1>,
            .suits = has_shape<kShape>}}};
}

constexpr auto kVariants = joined(variants<TileShape::kSmall>(), variants<TileShape::kWide>());

}  // namespace

std::span<const ShaderVariant> pose_bounds_variants() { return kVariants; }

}  // namespace gdtslam

#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "grid_launch.hpp"
#include "variant_tools.hpp"

namespace gdtslam {
namespace {

template <std::uint32_t kQuads, std::uint32_t kRowsEach>
GroupCount groups(const LaunchShape& shape) {
  const auto params = launch_params<JumpFloodDistance>(shape);
  return grid_groups(divided_up(params.width, 4), kQuads, params.height, kRowsEach);
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "jump_flood_distance",
     .name = "jump_flood_distance",
     .spirv = shader::jump_flood_distance_spirv,
     .local_size = {32, 1, 1},
     .groups = groups<32, 16>,
     .suits = wants_narrow},
    {.kernel = "jump_flood_distance",
     .name = "jump_flood_distance",
     .spirv = shader::jump_flood_distance_spirv,
     .local_size = {128, 1, 1},
     .groups = groups<128, 1>},
};

}  // namespace

std::span<const ShaderVariant> jump_flood_distance_variants() { return kVariants; }

}  // namespace gdtslam

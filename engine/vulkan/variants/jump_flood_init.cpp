#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "grid_launch.hpp"
#include "variant_tools.hpp"

namespace gdtslam {
namespace {

template <std::uint32_t kQuads, std::uint32_t kRowsEach>
GroupCount groups(const LaunchShape& shape) {
  const auto params = launch_params<JumpFloodInit>(shape);
  return grid_groups(divided_up(params.width, 4), kQuads, params.height, kRowsEach);
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "jump_flood_init",
     .name = "jump_flood_init",
     .spirv = shader::jump_flood_init_spirv,
     .local_size = {32, 1, 1},
     .groups = groups<32, 16>,
     .suits = wants_narrow},
    {.kernel = "jump_flood_init",
     .name = "jump_flood_init",
     .spirv = shader::jump_flood_init_spirv,
     .local_size = {128, 1, 1},
     .groups = groups<128, 1>},
};

}  // namespace

std::span<const ShaderVariant> jump_flood_init_variants() { return kVariants; }

}  // namespace gdtslam

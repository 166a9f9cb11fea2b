#include "forms/form_tools.hpp"
#include "forms/grid_launch.hpp"
#include "gdtslam/compute/kernels/jump_flood.hpp"

namespace gdtslam {
namespace {

template <std::uint32_t kQuads, std::uint32_t kRowsEach>
GroupCount groups(const LaunchShape& shape) {
  const auto params = launch_params<JumpFloodDistance>(shape);
  return grid_groups(divided_up(params.width, 4), kQuads, params.height, kRowsEach);
}

constexpr ShaderForm kForms[] = {
    {.kernel = "jump_flood_distance",
     .name = "jump_flood_distance",
     .spirv = shader::jump_flood_distance_spirv,
     .local_size = {128, 1, 1},
     .groups = groups<128, 1>,
     .suits = wants_wide},
    {.kernel = "jump_flood_distance",
     .name = "jump_flood_distance",
     .spirv = shader::jump_flood_distance_spirv,
     .local_size = {32, 1, 1},
     .groups = groups<32, 16>},
};

}  // namespace

std::span<const ShaderForm> jump_flood_distance_forms() { return kForms; }

}  // namespace gdtslam

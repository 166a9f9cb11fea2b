#include "gdtslam/compute/kernels/sweep_points.hpp"

#include "forms/form_tools.hpp"

namespace gdtslam {
namespace {

template <std::uint32_t kBeams>
GroupCount groups(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kBeams);
}

constexpr ShaderForm kForms[] = {
    {.kernel = "sweep_points",
     .name = "sweep_points",
     .spirv = shader::sweep_points_spirv,
     .local_size = {128, 1, 1},
     .constants = {1, 0},
     .groups = groups<128>,
     .suits = wants_wide},
    {.kernel = "sweep_points",
     .name = "sweep_points",
     .spirv = shader::sweep_points_spirv,
     .local_size = {32, 1, 1},
     .constants = {8, 0},
     .groups = groups<32 * 8>},
};

}  // namespace

std::span<const ShaderForm> sweep_points_forms() { return kForms; }

}  // namespace gdtslam

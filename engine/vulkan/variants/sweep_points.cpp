#include "engine/compute/kernels/sweep_points/sweep_points.hpp"

#include "variant_tools.hpp"

namespace gdtslam {
namespace {

template <std::uint32_t kBeams>
GroupCount groups(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kBeams);
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "sweep_points",
     .name = "sweep_points",
     .spirv = shader::sweep_points_spirv,
     .local_size = {32, 1, 1},
     .constants = {8, 0},
     .groups = groups<32 * 8>,
     .suits = wants_narrow},
    {.kernel = "sweep_points",
     .name = "sweep_points",
     .spirv = shader::sweep_points_spirv,
     .local_size = {128, 1, 1},
     .constants = {1, 0},
     .groups = groups<128>},
};

}  // namespace

std::span<const ShaderVariant> sweep_points_variants() { return kVariants; }

}  // namespace gdtslam

#include "engine/compute/kernels/distance_field/distance_field.hpp"

#include "grid_launch.hpp"
#include "variant_tools.hpp"

namespace gdtslam {
namespace {

template <std::uint32_t kQuads, std::uint32_t kRowsEach>
GroupCount groups(const LaunchShape& shape) {
  const auto params = launch_params<DistanceField>(shape);
  return grid_groups(divided_up(params.width, 4), kQuads, params.height, kRowsEach);
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "distance_field",
     .name = "distance_field",
     .spirv = shader::distance_field_spirv,
     .local_size = {32, 1, 1},
     .groups = groups<32, 16>,
     .suits = wants_narrow},
    {.kernel = "distance_field",
     .name = "distance_field",
     .spirv = shader::distance_field_spirv,
     .local_size = {128, 1, 1},
     .groups = groups<128, 1>},
};

}  // namespace

std::span<const ShaderVariant> distance_field_variants() { return kVariants; }

}  // namespace gdtslam

#include "variant_tools.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kGroup = 64;

GroupCount groups(const LaunchShape& shape) { return groups_for(shape.threads.x, kGroup); }

constexpr ShaderVariant kVariants[] = {
    {.kernel = "seed_scatter",
     .name = "seed_scatter",
     .spirv = shader::seed_scatter_spirv,
     .local_size = {kGroup, 1, 1},
     .groups = groups},
};

}  // namespace

std::span<const ShaderVariant> seed_scatter_variants() { return kVariants; }

}  // namespace gdtslam

#include "variant_tools.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kGroup = 32;

GroupCount groups(const LaunchShape& shape) { return groups_for(shape.threads.x, kGroup); }

constexpr ShaderVariant kVariants[] = {
    {.kernel = "pose_starts",
     .name = "pose_starts",
     .spirv = shader::pose_starts_spirv,
     .local_size = {kGroup, 1, 1},
     .takes_count = true,
     .groups = groups},
};

}  // namespace

std::span<const ShaderVariant> pose_starts_variants() { return kVariants; }

}  // namespace gdtslam

#include "forms/form_tools.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kGroup = 64;

GroupCount groups(const LaunchShape& shape) { return groups_for(shape.threads.x, kGroup); }

constexpr ShaderForm kForms[] = {
    {.kernel = "seed_scatter",
     .name = "seed_scatter",
     .spirv = shader::seed_scatter_spirv,
     .local_size = {kGroup, 1, 1},
     .groups = groups},
};

}  // namespace

std::span<const ShaderForm> seed_scatter_forms() { return kForms; }

}  // namespace gdtslam

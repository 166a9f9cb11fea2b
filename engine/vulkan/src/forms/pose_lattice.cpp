#include "gdtslam/compute/kernels/pose_lattice.hpp"

#include "forms/form_tools.hpp"

namespace gdtslam {
namespace {

/// Samples of an invocation on a CPU, where a group costs more than a sample.
constexpr std::uint32_t kNarrowSamples = 8;

template <std::uint32_t kPerGroup>
GroupCount groups(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kPerGroup);
}

constexpr ShaderForm kForms[] = {
    {.kernel = "pose_lattice",
     .name = "pose_lattice",
     .spirv = shader::pose_lattice_spirv,
     .local_size = {128, 1, 1},
     .constants = {1, 0},
     .groups = groups<128>,
     .suits = wants_wide},
    {.kernel = "pose_lattice",
     .name = "pose_lattice",
     .spirv = shader::pose_lattice_spirv,
     .local_size = {64, 1, 1},
     .constants = {kNarrowSamples, 0},
     .groups = groups<64 * kNarrowSamples>},
};

}  // namespace

std::span<const ShaderForm> pose_lattice_forms() { return kForms; }

}  // namespace gdtslam
